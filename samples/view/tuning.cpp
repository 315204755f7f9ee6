// See samples/view/tuning.h.
#include "samples/view/tuning.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/fields.h"
#include "samples/view/lists.h"

namespace weft::view {
namespace {

using scene_fields::Names;
using scene_fields::Range;

std::string in_words(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

// "0 ... 100 m/s", or "above 0, at most 1000 kg/m^2".
std::string in_words(const Range& range) {
  std::string words = in_words(range.low);
  if (range.above) words.insert(0, "above ");
  else if (range.below) words.insert(0, "at least ");
  words += range.below ? ", below " : range.above ? ", at most " : " ... ";
  words += in_words(range.high);
  if (!range.unit.empty()) words.append(" ").append(range.unit);
  return words;
}

// A value within the range; where an end is not in it, the next number inside.
double within(double value, const Range& range) {
  const double low = range.above ? std::nextafter(static_cast<float>(range.low), std::numeric_limits<float>::infinity()) : range.low;
  const double high = range.below ? std::nextafter(static_cast<float>(range.high), -std::numeric_limits<float>::infinity()) : range.high;
  return std::clamp(value, low, high);
}

// A visitor with the members that engine/scene/fields.h lists.
struct Widgets {
  explicit Widgets(Tuning& remembered) : tuning(&remembered) {}

  Tuning* tuning;
  bool changed = false;
  std::string labelled, path;

  // ImGui wants it ended by a zero, and is done with it when it returns.
  const char* label(std::string_view key) {
    labelled = key;
    return labelled.c_str();
  }
  static void tell(const std::string& what) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", what.c_str());
  }
  void if_done() { changed |= ImGui::IsItemDeactivatedAfterEdit(); }
  void if_now(bool now) { changed |= now; }

  // What is in an object has its key before its own.
  template <class Draw>
  void within_key(std::string_view key, Draw draw) {
    const std::size_t had = path.size();
    path.append(had == 0 ? "" : ".").append(key);
    draw();
    path.resize(had);
  }

  // A list as a line of text. While it is typed the text is what was typed; `read` gets it when it is let go of.
  template <class Read>
  void line(std::string_view key, const std::string& now, Read read) {
    const ImGuiID id = ImGui::GetID(label(key));
    std::string text = tuning->typed_in == id ? tuning->typed : now;
    ImGui::InputText(label(key), &text, ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemActive()) {
      tuning->typed_in = id;
      tuning->typed = text;
      return;
    }
    if (tuning->typed_in != id) return;
    tuning->typed_in = 0;
    if (text == now) return;
    if (const Result<void> done = read(text); done) changed = true;
    else within_key(key, [&] { tuning->faults.push_back(path + ": " + done.error()); });
  }

  void note(std::string_view) {}
  void text(std::string_view key, std::string& value) {
    ImGui::InputText(label(key), &value, ImGuiInputTextFlags_EnterReturnsTrue);
    if_done();
  }
  void flag(std::string_view key, bool& value) { if_now(ImGui::Checkbox(label(key), &value)); }
  void optional_flag(std::string_view key, std::optional<bool>& value) {
    int chosen = !value ? 0 : *value ? 1 : 2;
    if (!ImGui::Combo(label(key), &chosen, "by itself\0yes\0no\0")) return;
    value = chosen == 0 ? std::nullopt : std::optional(chosen == 1);
    changed = true;
  }
  void number(std::string_view key, double& value, const Range& range) {
    const float speed = static_cast<float>(std::max(0.01 * std::abs(value), 1e-6 * (std::min(range.high, 1e3) - range.low)));
    if (ImGui::DragScalar(label(key), ImGuiDataType_Double, &value, speed, nullptr, nullptr, "%.6g")) value = within(value, range);
    if_done();
    tell(in_words(range));
  }
  void optional_number(std::string_view key, std::optional<double>& value, const Range& range) {
    ImGui::PushID(label(key));
    bool is_set = value.has_value();
    if (ImGui::Checkbox("##set", &is_set)) {
      value = is_set ? std::optional(within(std::clamp(1.0, range.low, range.high), range)) : std::nullopt;
      changed = true;
    }
    tell("set it; without it is chosen");
    ImGui::SameLine();
    if (value) number(key, *value, range);
    else ImGui::TextDisabled("%s", label(key));
    ImGui::PopID();
  }
  void stiffness(std::string_view key, double& value, const Range& range) {
    ImGui::PushID(label(key));
    bool rigid = std::isinf(value);
    if (ImGui::Checkbox("rigid", &rigid)) {
      value = rigid ? std::numeric_limits<double>::infinity() : 1000;
      changed = true;
    }
    ImGui::SameLine();
    if (rigid) ImGui::TextDisabled("%s", label(key));
    else number(key, value, range);
    ImGui::PopID();
  }
  void whole(std::string_view key, std::uint32_t& value, const Range& range) {
    if (ImGui::DragScalar(label(key), ImGuiDataType_U32, &value, 0.2f))
      value = static_cast<std::uint32_t>(std::clamp<double>(value, range.low, range.high));
    if_done();
    tell(in_words(range));
  }
  template <class E>
  void choice(std::string_view key, E& value, Names names) {
    const std::string chosen(names[static_cast<std::size_t>(value)]);
    if (!ImGui::BeginCombo(label(key), chosen.c_str())) return;
    for (std::size_t k = 0; k < names.size(); ++k)
      if (ImGui::Selectable(std::string(names[k]).c_str(), k == static_cast<std::size_t>(value)) && k != static_cast<std::size_t>(value)) {
        value = static_cast<E>(k);
        changed = true;
      }
    ImGui::EndCombo();
  }
  template <class E>
  void choices(std::string_view key, std::vector<E>& value, Names names) {
    if (!ImGui::TreeNode(label(key))) return;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto at = std::find(value.begin(), value.end(), static_cast<E>(k));
      bool is_in = at != value.end();
      if (!ImGui::Checkbox(std::string(names[k]).c_str(), &is_in)) continue;
      if (is_in) value.push_back(static_cast<E>(k));
      else value.erase(at);
      changed = true;
    }
    ImGui::TreePop();
  }
  void vector2(std::string_view key, Vec2& value, const Range& range) {
    if (ImGui::DragScalarN(label(key), ImGuiDataType_Float, &value.x, 2, 0.01f, nullptr, nullptr, "%.4g"))
      value = {static_cast<float>(within(value.x, range)), static_cast<float>(within(value.y, range))};
    if_done();
    tell(in_words(range));
  }
  void vector3(std::string_view key, Vec3& value, const Range& range) {
    if (ImGui::DragScalarN(label(key), ImGuiDataType_Float, &value.x, 3, 0.01f, nullptr, nullptr, "%.4g"))
      value = {static_cast<float>(within(value.x, range)), static_cast<float>(within(value.y, range)),
               static_cast<float>(within(value.z, range))};
    if_done();
    tell(in_words(range));
  }
  void colour(std::string_view key, Vec3& value, const Range&) {
    ImGui::ColorEdit3(label(key), &value.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
    if_done();
  }
  void direction(std::string_view key, Vec3& value) {
    ImGui::DragFloat3(label(key), &value.x, 0.01f);
    if_done();
    tell("a direction; its length does not matter");
  }
  void unit(std::string_view key, Vec3& value) { direction(key, value); }
  void cells(std::string_view key, std::uint32_t& x, std::uint32_t& y, const Range& range) {
    int both[] = {static_cast<int>(x), static_cast<int>(y)};
    ImGui::InputInt2(label(key), both, ImGuiInputTextFlags_EnterReturnsTrue);
    x = static_cast<std::uint32_t>(std::clamp<double>(both[0], range.low, range.high));
    y = static_cast<std::uint32_t>(std::clamp<double>(both[1], range.low, range.high));
    if_done();
    tell(in_words(range) + ", along the warp and the weft");
  }
  void file(std::string_view key, std::string& value, Names endings) {
    text(key, value);
    std::string all;
    for (const std::string_view ending : endings) all += (all.empty() ? "" : ", ") + std::string(ending);
    tell("a file: " + all);
  }
  void whole_list(std::string_view key, std::vector<std::uint32_t>& value, const Range& range, std::size_t most) {
    constexpr std::size_t kLongest = 10'000;   // its line is made anew every frame
    if (value.size() > kLongest) return ImGui::TextDisabled("%s: %zu numbers", label(key), value.size());
    line(key, in_a_line(value), [&](const std::string& text) -> Result<void> {
      auto read = numbers_in(text, range, std::min(most, kLongest));
      if (!read) return read.take_error();
      value = std::move(*read);
      return {};
    });
    tell("whole numbers, " + in_words(range) + "; 3-7 are five of them");
  }
  void optional_texts(std::string_view key, std::optional<std::vector<std::string>>& value, std::size_t most) {
    ImGui::PushID(label(key));
    bool is_set = value.has_value();
    if (ImGui::Checkbox("##set", &is_set)) {
      value = is_set ? std::optional(std::vector<std::string>()) : std::nullopt;
      changed = true;
    }
    tell("set it; without it is all");
    ImGui::SameLine();
    if (value)
      line(key, in_a_line(*value), [&](const std::string& text) -> Result<void> {
        auto read = names_in(text, most);
        if (!read) return read.take_error();
        value = std::move(*read);
        return {};
      });
    else ImGui::TextDisabled("%s: all", label(key));
    ImGui::PopID();
  }
  template <class T>
  void object(std::string_view key, T& value) {
    if (!ImGui::TreeNode(label(key))) return;
    within_key(key, [&] { scene_fields::fields(*this, value); });
    ImGui::TreePop();
  }
  template <class T>
  void optional_object(std::string_view key, std::optional<T>& value) {
    ImGui::PushID(label(key));
    bool is_there = value.has_value();
    if (ImGui::Checkbox("##there", &is_there)) {
      if (is_there) value.emplace();
      else value.reset();
      changed = true;
    }
    ImGui::SameLine();
    if (value) object(key, *value);
    else ImGui::TextDisabled("%s", label(key));
    ImGui::PopID();
  }
  template <class T>
  void list(std::string_view key, std::vector<T>& value, std::size_t least, std::size_t most) {
    if (!ImGui::TreeNode(label(key), "%s (%zu)", std::string(key).c_str(), value.size())) return;
    for (std::size_t k = 0; k < value.size(); ++k) {
      ImGui::PushID(static_cast<int>(k));
      const bool is_open = ImGui::TreeNode("entry", "%zu", k);
      if (is_open) {
        within_key(std::string(key) + '[' + std::to_string(k) + ']', [&] { scene_fields::fields(*this, value[k]); });
        const bool goes = value.size() > least && ImGui::SmallButton("remove");
        ImGui::TreePop();
        if (goes) {
          value.erase(value.begin() + static_cast<std::ptrdiff_t>(k));
          changed = true;
        }
      }
      ImGui::PopID();
    }
    if (value.size() < most && !value.empty() && ImGui::SmallButton("add one like the last")) {
      value.push_back(T(value.back()));
      changed = true;
    }
    if (value.empty() && most > 0 && ImGui::SmallButton("add one")) {
      value.emplace_back();
      changed = true;
    }
    ImGui::TreePop();
  }
  void fabric(std::string_view key, Fabric& value) {
    ImGui::PushID(label(key));
    if (ImGui::BeginCombo("fabric", value.preset.c_str())) {
      for (const char* name : {"silk", "cotton", "denim", "leather"})
        if (ImGui::Selectable(name, value.preset == name)) {
          value = *fabric_preset(name);
          changed = true;
        }
      ImGui::EndCombo();
    }
    object("its figures", value);
    ImGui::PopID();
  }
  void tethers(std::string_view key, Cloth& value) {
    ImGui::PushID(label(key));
    if_now(ImGui::Checkbox("tethers", &value.tethers));
    if (value.tethers) {
      whole("tethers a vertex", value.tethers_per_vertex, scene_fields::between(1, 8));
      optional_number("slack", value.tether_slack, scene_fields::between(0, 1));
    }
    ImGui::PopID();
  }
  void contacts(std::string_view key, Contacts& value) { object(key, value); }
};

}  // namespace

bool tune(Scene& scene, Tuning& tuning) {
  Widgets widgets(tuning);
  ImGui::PushItemWidth(0.5f * ImGui::GetContentRegionAvail().x);
  scene_fields::fields(widgets, scene);
  ImGui::PopItemWidth();
  return widgets.changed;
}

}  // namespace weft::view
