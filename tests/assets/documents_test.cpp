// What the documents say of the repository is so: links and paths lead somewhere, the table of passes names the passes there are, examples
// are the programs and scenes that they claim to be, and the first page stays a page.
//
// Markdown is read as far as these documents use it: fenced and indented code, code spans, headings, links, and images in HTML.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/effects/effect.h"
#include "engine/scene.h"

namespace weft {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = WEFT_SOURCE_DIR;
constexpr std::size_t kPage = 15360;   // bytes: what a reader takes in at one sitting

struct Document {
  fs::path file;
  std::string prose;                    // without code
  std::vector<std::string> spans;       // `code` in the prose
  std::vector<std::string> headings;    // without their #
  std::vector<std::pair<std::string, std::string>> blocks;   // fenced: language and code
};

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Takes the code spans out of the prose.
void take_spans(Document& document) {
  std::string rest;
  std::size_t at = 0;
  for (std::size_t open; (open = document.prose.find('`', at)) != std::string::npos;) {
    const std::size_t close = document.prose.find('`', open + 1);
    if (close == std::string::npos) break;
    rest.append(document.prose, at, open - at);
    document.spans.push_back(document.prose.substr(open + 1, close - open - 1));
    at = close + 1;
  }
  document.prose = rest.append(document.prose, at);
}

Document read_document(const fs::path& file) {
  Document document;
  document.file = file;
  std::istringstream lines(text_of(file));
  bool fenced = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      fenced = !fenced;
      if (fenced) document.blocks.emplace_back(line.substr(3), "");
    } else if (fenced) {
      document.blocks.back().second += line + '\n';
    } else if (!line.starts_with("    ")) {
      if (line.starts_with('#')) document.headings.push_back(line.substr(std::min(line.size(), line.find_first_not_of("# "))));
      document.prose += line + '\n';
    }
  }
  EXPECT_FALSE(fenced) << file << ": a fence is not closed";
  take_spans(document);
  return document;
}

const std::vector<Document>& documents() {
  static const std::vector<Document> all = [] {
    std::vector<Document> found;
    const std::set<fs::path> skipped{".git", "build", "out"};
    for (auto at = fs::recursive_directory_iterator(kRoot); at != fs::recursive_directory_iterator(); ++at) {
      if (at->is_directory() && skipped.contains(at->path().filename())) at.disable_recursion_pending();
      else if (at->is_regular_file() && at->path().extension() == ".md") found.push_back(read_document(at->path()));
    }
    return found;
  }();
  return all;
}

// Everything between `before` and `after`.
void collect(const std::string& text, std::string_view before, char after, std::vector<std::string>& found) {
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
    at += before.size();
    found.push_back(text.substr(at, text.find(after, at) - at));
  }
}

// Links out of the repository are nobody's to check here.
std::vector<std::string> relative_links(const Document& document) {
  std::vector<std::string> links;
  collect(document.prose, "](", ')', links);
  collect(document.prose, " src=\"", '"', links);
  collect(document.prose, " href=\"", '"', links);
  std::erase_if(links, [](const std::string& link) { return link.find("://") != std::string::npos || link.starts_with("mailto:"); });
  return links;
}

// As GitHub makes them: lower case, hyphens for spaces, no punctuation, and a number where one comes again.
std::set<std::string> anchors_of(const std::vector<std::string>& headings) {
  std::set<std::string> anchors;
  std::map<std::string, int> seen;
  for (const std::string& heading : headings) {
    std::string slug;
    for (const char c : heading) {
      const auto byte = static_cast<unsigned char>(c);
      if (c == ' ') slug += '-';
      else if (c == '-' || c == '_' || byte >= 0x80 || std::isalnum(byte) != 0) slug += static_cast<char>(std::tolower(byte));
    }
    const int before = seen[slug]++;
    anchors.insert(before == 0 ? slug : slug + '-' + std::to_string(before));
  }
  return anchors;
}

// A span's path from the repository's root; empty if it names none, or none that is committed.
std::string path_in(const std::string& span) {
  std::string path = span.substr(0, span.find_first_of(" \n\t"));
  constexpr std::string_view kRooms[] = {"engine/", "compute/", "shaders/", "assets/", "tests/", "samples/"};
  if (std::none_of(std::begin(kRooms), std::end(kRooms), [&](std::string_view room) { return path.starts_with(room); })) return {};
  if (path.find_first_of("*?<>{}[]$") != std::string::npos || path.starts_with("assets/generated")) return {};
  const std::size_t colon = path.rfind(':');
  if (colon != std::string::npos && colon + 1 < path.size() && path.find_first_not_of("0123456789", colon + 1) == std::string::npos)
    path.resize(colon);
  return path;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" `"), last = text.find_last_not_of(" `");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// The first column of the table whose head begins with "| pass |", a name each.
std::vector<std::string> passes_in_table(const fs::path& file) {
  std::vector<std::string> names;
  std::istringstream lines(text_of(file));
  std::string line;
  while (std::getline(lines, line) && !line.starts_with("| pass |")) {}
  std::getline(lines, line);   // the rule below the head
  while (std::getline(lines, line) && line.starts_with('|')) {
    const std::string cell = trimmed(line.substr(1, line.find('|', 1) - 1));
    if (cell.starts_with('+') || cell.starts_with("…")) continue;   // a part of passes
    std::istringstream listed(cell);
    for (std::string name; std::getline(listed, name, ',');) names.push_back(trimmed(name));
  }
  return names;
}

TEST(Documents, the_first_page_is_a_page) { EXPECT_LE(fs::file_size(kRoot / "README.md"), kPage); }

TEST(Documents, every_link_leads_to_a_file_and_a_heading_that_exist) {
  std::size_t links = 0;
  for (const Document& document : documents())
    for (const std::string& link : relative_links(document)) {
      ++links;
      const std::size_t hash = link.find('#');
      const fs::path target = hash == 0 ? document.file : document.file.parent_path() / link.substr(0, hash);
      if (!fs::exists(target)) {
        ADD_FAILURE() << document.file << ": " << link << " leads nowhere";
      } else if (hash != std::string::npos) {
        EXPECT_EQ(target.extension().string(), ".md") << document.file << ": " << link << " has no headings";
        EXPECT_TRUE(anchors_of(read_document(target).headings).contains(link.substr(hash + 1)))
            << document.file << ": " << link << " leads to no heading";
      }
    }
  EXPECT_GT(links, 20u);
}

TEST(Documents, every_path_they_name_exists) {
  std::size_t paths = 0;
  for (const Document& document : documents())
    for (const std::string& span : document.spans) {
      const std::string path = path_in(span);
      if (path.empty()) continue;
      ++paths;
      EXPECT_TRUE(fs::exists(kRoot / path)) << document.file << ": " << path;
    }
  EXPECT_GT(paths, 20u);
}

TEST(Documents, the_table_of_passes_names_those_that_effects_declare) {
  std::vector<std::string> declared, named = passes_in_table(kRoot / "shaders/README.md");
  for (const Effect* effect : all_effects())
    for (const Pass& pass : effect->passes) declared.emplace_back(pass.name);
  std::sort(declared.begin(), declared.end());
  std::sort(named.begin(), named.end());
  EXPECT_EQ(named, declared);
}

TEST(Documents, the_first_page_quotes_the_example_as_it_is) {
  const Document page = read_document(kRoot / "README.md");
  const auto block = std::find_if(page.blocks.begin(), page.blocks.end(), [](const auto& b) { return b.first == "cpp"; });
  ASSERT_TRUE(block != page.blocks.end());
  EXPECT_EQ(block->second, text_of(kRoot / "samples/embedding.cpp"));
}

TEST(Documents, every_example_of_a_scene_is_one) {
  std::size_t scenes = 0;
  for (const Document& document : documents())
    for (const auto& [language, code] : document.blocks) {
      if (language != "json") continue;
      ++scenes;
      const Result<Scene> scene = parse_scene(code, document.file.parent_path());
      EXPECT_TRUE(scene) << document.file << ": " << scene.error() << "\n" << code;
    }
  EXPECT_GT(scenes, 10u);
}

}  // namespace
}  // namespace weft
