// Dear ImGui in the window: made once, and its letters anew where the window comes to a monitor of another density.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "samples/view/window.h"

namespace weft::view {

Result<void> Window::create_interface() {
  const VkDescriptorPoolSize images{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 8};
  auto create = compute::typed<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  create.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  create.maxSets = 8;
  create.poolSizeCount = 1;
  create.pPoolSizes = &images;
  if (const VkResult made = vkCreateDescriptorPool(device_->handle(), &create, nullptr, &descriptors_); made != VK_SUCCESS)
    return fail("making the interface's pool failed: ", compute::result_name(made));
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;   // nothing is left behind where it runs
  has_interface_ = true;
  ImGui_ImplGlfw_InitForVulkan(window_, true);
  return create_letters();
}

// Letters, and the room about them, as large as the monitor's density wants them. Where screen coordinates are not pixels, they are scaled
// already.
Result<void> Window::create_letters() {
  constexpr float kLetters = 13;   // pixels: Dear ImGui's own
  float scale = 1;
  int pixels = 0, points = 0;
  glfwGetWindowContentScale(window_, &scale, nullptr);
  glfwGetFramebufferSize(window_, &pixels, nullptr);
  glfwGetWindowSize(window_, &points, nullptr);
  if (pixels > 0) scale *= static_cast<float>(points) / static_cast<float>(pixels);
  if (!(scale >= 0.5f && scale <= 8)) scale = 1;   // no monitor's
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;
  ImFontConfig letters;
  letters.SizePixels = std::floor(kLetters * scale);
  // The last ones go with all that drew them: Dear ImGui's renderer has no other way to be rid of their picture.
  if (ImGui::GetIO().BackendRendererUserData != nullptr) {
    ImGui_ImplVulkan_Shutdown();
    vkResetDescriptorPool(device_->handle(), descriptors_, 0);
  }
  ImGui::GetIO().Fonts->Clear();
  ImGui::GetIO().Fonts->AddFontDefault(&letters);
  ImGui_ImplVulkan_InitInfo init{};
  init.Instance = device_->instance();
  init.PhysicalDevice = device_->physical();
  init.Device = device_->handle();
  init.QueueFamily = device_->queue_family();
  init.Queue = device_->queue();
  init.DescriptorPool = descriptors_;
  init.MinImageCount = 2;
  init.ImageCount = std::max<std::uint32_t>(2, static_cast<std::uint32_t>(targets_.size()));
  init.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  if (!ImGui_ImplVulkan_Init(&init, pass_)) return fail("the interface could not be made on ", device_->name());
  auto sent = compute::run_once(*device_, "fonts", [](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
  if (!sent) return sent;
  ImGui_ImplVulkan_DestroyFontUploadObjects();
  has_letters_ = true;
  return {};
}

}  // namespace weft::view
