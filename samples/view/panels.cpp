// The panels: the player, the look, figures, the scene's keys, and what went wrong.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "samples/view/viewer.h"
#include "samples/weft/files.h"

namespace weft::view {
namespace {

constexpr std::array kColourings = {"lit", "strain", "normals", "albedo map", "normal map", "roughness map", "occlusion map"};

// Lengths that were chosen beside letters of 13 pixels; they grow with these.
float scaled(float pixels) { return pixels * ImGui::GetFontSize() / 13; }
float panel_width() { return scaled(340); }

constexpr const char* kHelp =
    "left drag on cloth    grab and throw\n"
    "left drag elsewhere   turn (right drag: always)\n"
    "shift or middle drag  pan\n"
    "wheel                 zoom\n"
    "ctrl + click          pin a vertex, or let go of it\n"
    "space                 play, pause\n"
    ".                     a single frame\n"
    "R                     from the start\n"
    "F                     all cloth in view\n"
    "K, backspace          keep this moment, go back to the last one\n"
    "G                     a ball that follows the pointer\n"
    "X, then draw a line   cut cloth\n"
    "0                     the rendered picture\n"
    "1 ... 7               lit, strain, normals, the four maps\n"
    "W N A C B O           wires, normals, anchors, contacts, bounds, colliders\n"
    "tab, H                panels, this help\n"
    "ctrl + Q              quit";

ImU32 packed(Vec3 colour) { return ImGui::GetColorU32(ImVec4(colour.x, colour.y, colour.z, 1)); }

// The colours of strain with their ends.
void draw_legend(float strain) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = ImGui::GetTextLineHeight();
  constexpr int kSteps = 48;
  for (int k = 0; k < kSteps; ++k) {
    const float from = width * static_cast<float>(k) / kSteps, to = width * static_cast<float>(k + 1) / kSteps;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x + from, at.y), ImVec2(at.x + to, at.y + height),
                                              packed(strain_colour(2 * (static_cast<float>(k) + 0.5f) / kSteps - 1)));
  }
  ImGui::Dummy(ImVec2(width, height));
  ImGui::Text("-%.3g %%", 100 * static_cast<double>(strain));
  ImGui::SameLine(0.5f * width);
  ImGui::TextUnformatted("0");
  ImGui::SameLine(width - scaled(48));
  ImGui::Text("+%.3g %%", 100 * static_cast<double>(strain));
}

std::string in_bytes(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f MB", static_cast<double>(bytes) / 1e6);
  return text;
}

}  // namespace

// Where it was: what the pointer does there is not the cloth's.
void Viewer::end_panel() {
  const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  panels_.push_back({at.x, at.y, at.x + size.x, at.y + size.y});
  ImGui::End();
}

void Viewer::draw_panels() {
  panels_.clear();
  // The window's own frame of the interface has begun with begin().
  const ImGuiIO& io = ImGui::GetIO();
  if (shows_panels_) {
    ImGui::SetNextWindowPos(ImVec2(scaled(8), scaled(8)));
    ImGui::SetNextWindowSize(ImVec2(panel_width(), io.DisplaySize.y - scaled(16)));
    ImGui::Begin("Weft", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
    if (stage_) {
      draw_player();
      if (ImGui::CollapsingHeader("Look", ImGuiTreeNodeFlags_DefaultOpen)) draw_look();
      if (ImGui::CollapsingHeader("Figures", ImGuiTreeNodeFlags_DefaultOpen)) draw_figures();
      if (ImGui::CollapsingHeader("Scene")) draw_scene();
    } else {
      ImGui::TextWrapped("There is nothing to show. Drop a scene (.json) or a mesh (.gltf, .glb, .obj, .ply, .stl, .dae, .fbx) here.");
    }
    end_panel();
  }
  draw_messages();
  if (!shows_help_) return;
  ImGui::SetNextWindowPos(ImVec2(0.5f * io.DisplaySize.x, 0.4f * io.DisplaySize.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  ImGui::Begin("Help", &shows_help_, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
  ImGui::TextUnformatted(kHelp);
  end_panel();
}

void Viewer::draw_player() {
  if (ImGui::Button(is_playing_ ? "Pause" : "Play", ImVec2(scaled(64), 0))) set_playing(!is_playing_);
  ImGui::SameLine();
  if (ImGui::Button("Step")) step_alone();
  ImGui::SameLine();
  if (ImGui::Button("Reset")) reset();
  ImGui::SameLine();
  if (ImGui::Button("Frame")) frame_all();
  ImGui::SameLine();
  if (ImGui::Button("Help")) shows_help_ = !shows_help_;
  auto speed = static_cast<float>(speed_);
  ImGui::SetNextItemWidth(0.5f * panel_width());
  constexpr ImGuiSliderFlags kSlides = ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp;
  if (ImGui::SliderFloat("of real time", &speed, 0.02f, 1, "%.2f", kSlides)) speed_ = speed;
  ImGui::Text("frame %llu, %.2f s", static_cast<unsigned long long>(stage_->frame()), stage_->simulation().time());
  if (ImGui::Button("Keep this moment")) keep();
  for (std::size_t k = 0; k < stage_->kept().size(); ++k) {
    const Keepsake& one = stage_->kept()[k];
    char name[64];
    std::snprintf(name, sizeof name, "%llu##%zu", static_cast<unsigned long long>(one.frame), k);
    if (k % 5 != 0) ImGui::SameLine();
    if (ImGui::Button(name)) {
      go_back(k);
      break;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("back to frame %llu, %.2f s", static_cast<unsigned long long>(one.frame), one.time);
  }
}

void Viewer::draw_look() {
  ImGui::Checkbox("rendered", &is_rendered_);
  if (window_->device().is_software() && is_rendered_) {
    ImGui::SameLine();
    ImGui::TextDisabled("slow: no GPU");
  }
  if (!is_rendered_) {
    auto colouring = static_cast<int>(look_.colouring);
    ImGui::SetNextItemWidth(0.5f * panel_width());
    if (ImGui::Combo("colours", &colouring, kColourings.data(), static_cast<int>(kColourings.size())))
      look_.colouring = static_cast<uint>(colouring);
    if (look_.colouring == VIEW_STRAIN) {
      float percent = 100 * look_.strain;
      ImGui::SetNextItemWidth(0.5f * panel_width());
      if (ImGui::SliderFloat("strain, %", &percent, 0.1f, 1000, "%.3g", ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
        look_.strain = 0.01f * percent;
      draw_legend(look_.strain);
    }
    ImGui::Checkbox("wires", &look_.wires);
    ImGui::SameLine();
    ImGui::Checkbox("normals", &look_.spikes);
    ImGui::SameLine();
    ImGui::Checkbox("anchors", &look_.anchors);
    ImGui::Checkbox("contacts", &shows_contacts_);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("candidate pairs: lines between the middles of their sides");
    ImGui::SameLine();
    ImGui::Checkbox("bounds", &shows_bounds_);
    ImGui::SameLine();
    ImGui::Checkbox("colliders", &look_.colliders);
  }
  bool ball = stage_->ball().has_value();
  if (ImGui::Checkbox("a ball follows the pointer", &ball)) toggle_ball();
  ImGui::SameLine();
  bool cuts = cuts_;
  if (ImGui::Checkbox("knife", &cuts)) toggle_knife();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("draw a line across cloth with the left button");
  if (ball) {
    ImGui::SetNextItemWidth(0.5f * panel_width());
    ImGui::SliderFloat("its radius, m", &ball_radius_, 0.01f, 10, "%.3g", ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemDeactivatedAfterEdit()) good(stage_->put_ball(ball_radius_));
  }
}

void Viewer::draw_figures() {
  const Simulation& simulation = stage_->simulation();
  const CookedFabric& fabric = simulation.fabric();
  ImGui::TextWrapped("%s", window_->device().name().c_str());
  if (window_->device().is_software()) ImGui::TextDisabled("This is a processor, not a GPU.");
  ImGui::Text("%zu particles, %zu links, %u triangles", fabric.positions.size(), fabric.links.size(),
              workbench_ ? workbench_->triangles() : 0u);
  std::uint64_t bytes = 0;
  for (const BufferUse& buffer : simulation.buffers()) bytes += buffer.bytes;
  ImGui::Text("buffers %s", in_bytes(bytes).c_str());
  ImGui::Text("simulated in %.1f ms, drawn in %.1f ms", simulated_ms_, window_->drawn_ms());
  const VkExtent2D size = picture_size(), whole = window_->size();
  // Always a line: what lies below must not move under the pointer.
  ImGui::TextDisabled("drawn at %u x %u of %u x %u", size.width, size.height, whole.width, whole.height);
  const Counts counts = simulation.counts();
  if (contacts_on(simulation.scene()))
    ImGui::Text("pairs at most %u, %u searches\nstopped short %u times, %u crossings", counts.contacts_most, counts.detections,
                counts.truncated, counts.crossings);
  if (counts.non_finite + counts.contacts_overflowed > 0)
    ImGui::TextColored(ImVec4(1, 0.4f, 0.3f, 1), "%u not finite, %u pairs without room", counts.non_finite, counts.contacts_overflowed);
  draw_times();
}

void Viewer::draw_times() {
  bool times = stage_->times_passes();
  if (ImGui::Checkbox("time passes", &times)) good(stage_->time_passes(times));   // another simulation from here on
  if (!times) return;
  const std::vector<PassTiming> passes = stage_->simulation().timings();
  double most = 1e-3;
  for (const PassTiming& pass : passes) most = std::max(most, pass.milliseconds);
  for (const PassTiming& pass : passes) {
    char text[128];
    std::snprintf(text, sizeof text, "%s: %.2f ms, %u", pass.name.c_str(), pass.milliseconds, pass.dispatches);
    ImGui::ProgressBar(static_cast<float>(pass.milliseconds / most), ImVec2(-1, 0), text);
  }
}

void Viewer::draw_scene() {
  ImGui::InputText("file", &save_as_);
  if (ImGui::Button("Save scene")) {
    const std::filesystem::path file = stage_->scene().folder / save_as_;
    if (save_as_.empty()) complain("a scene needs the name of a file to be saved under");
    else if (good(command::write_text(file, scene_text(stage_->scene())))) say("saved " + file.string());
  }
  if (tune(draft_, tuning_)) change_scene();
  for (const std::string& fault : std::exchange(tuning_.faults, {})) complain(fault);
}

void Viewer::draw_messages() {
  if (status_.empty() && faults_.empty()) return;
  const ImGuiIO& io = ImGui::GetIO();
  const float margin = scaled(8), left = shows_panels_ ? panel_width() + 2 * margin : margin;
  ImGui::SetNextWindowPos(ImVec2(left, io.DisplaySize.y - margin), ImGuiCond_Always, ImVec2(0, 1));
  const float room = std::max(scaled(200), io.DisplaySize.x - left - margin);
  ImGui::SetNextWindowSizeConstraints(ImVec2(scaled(100), 0), ImVec2(room, 0.5f * io.DisplaySize.y));
  constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
  ImGui::SetNextWindowBgAlpha(0.7f);
  ImGui::Begin("messages", nullptr, kPlain);
  for (const std::string& fault : faults_) ImGui::TextColored(ImVec4(1, 0.45f, 0.35f, 1), "%s", fault.c_str());
  if (!faults_.empty() && ImGui::SmallButton("Dismiss")) faults_.clear();
  if (!status_.empty()) ImGui::TextUnformatted(status_.c_str());
  end_panel();
}

}  // namespace weft::view
