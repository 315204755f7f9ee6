// See samples/view/window.h.
#include "samples/view/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

namespace weft::view {
namespace {

using compute::typed;

Result<void> checked(VkResult result, const char* what) {
  if (result != VK_SUCCESS) return fail(what, " failed: ", compute::result_name(result));
  return {};
}

std::string glfw_fault() {
  const char* why = nullptr;
  glfwGetError(&why);
  return why != nullptr ? why : "no reason was given";
}

void change_layout(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to) {
  auto barrier = typed<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
  barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

}  // namespace

Result<std::unique_ptr<Window>> Window::create(const WindowRequest& request) {
  std::unique_ptr<Window> made(new Window);
  if (auto done = made->create_surface(request); !done) return done.take_error();
  if (auto done = made->create_frame(); !done) return done.take_error();
  if (auto done = made->create_swapchain(); !done) return done.take_error();
  if (auto done = made->create_interface(); !done) return done.take_error();
  return made;
}

Result<void> Window::create_surface(const WindowRequest& request) {
  if (glfwInit() != GLFW_TRUE)
    return fail("no window can be opened (", glfw_fault(), "); without a screen, xvfb-run weft view makes one that nobody sees");
  if (glfwVulkanSupported() != GLFW_TRUE) return fail("this display has no Vulkan (", glfw_fault(), ")");
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (names == nullptr) return fail("Vulkan cannot draw into windows of this display (", glfw_fault(), ")");
  compute::DeviceChoice choice;
  choice.name = request.device;
  choice.validation = request.validation;
  choice.graphics = true;
  choice.instance_extensions.assign(names, names + count);
  choice.device_extensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  auto device = compute::Device::create(choice);
  if (!device) return device.take_error();
  device_ = std::move(*device);

  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  window_ = glfwCreateWindow(request.width, request.height, request.title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) return fail("the window could not be opened: ", glfw_fault());
  listen();
  if (auto done = checked(glfwCreateWindowSurface(device_->instance(), window_, nullptr, &surface_), "making the window's surface"); !done)
    return done;
  VkBool32 presents = VK_FALSE;
  vkGetPhysicalDeviceSurfaceSupportKHR(device_->physical(), device_->queue_family(), surface_, &presents);
  if (presents == VK_FALSE) return fail(device_->name(), " cannot present to this display");
  vkGetPhysicalDeviceSurfaceFormatsKHR(device_->physical(), surface_, &count, nullptr);
  std::vector<VkSurfaceFormatKHR> formats(count);
  vkGetPhysicalDeviceSurfaceFormatsKHR(device_->physical(), surface_, &count, formats.data());
  if (formats.empty()) return fail(device_->name(), " has no picture format for this display");
  // The interface's colours are sRGB already: no conversion on the way out. A picture's are converted by the blit.
  format_ = formats.front();
  for (const VkSurfaceFormatKHR& one : formats)
    if (one.format == VK_FORMAT_B8G8R8A8_UNORM || one.format == VK_FORMAT_R8G8B8A8_UNORM) {
      format_ = one;
      break;
    }
  return {};
}

Window& Window::of(GLFWwindow* window) {
  Window& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
  self.is_heard_ = true;
  return self;
}

// Before the interface listens: it calls these before its own.
void Window::listen() {
  glfwSetWindowUserPointer(window_, this);
  glfwGetCursorPos(window_, &x_, &y_);
  glfwSetDropCallback(window_, [](GLFWwindow* window, int files, const char** paths) {
    std::vector<std::filesystem::path>& dropped = of(window).dropped_;
    dropped.insert(dropped.end(), paths, paths + files);
  });
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int modifiers) {
    std::vector<Key>& keys = of(window).keys_;
    if (action != GLFW_RELEASE) keys.push_back({key, (modifiers & GLFW_MOD_CONTROL) != 0, action == GLFW_REPEAT});
  });
  glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned) { of(window); });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int modifiers) {
    const auto what = action == GLFW_PRESS ? Pointed::What::pressed : Pointed::What::released;
    Window& self = of(window);   // glfwGetCursorPos would say where the pointer is by now
    self.pointed_.push_back({what, button, self.x_, self.y_, (modifiers & GLFW_MOD_CONTROL) != 0, (modifiers & GLFW_MOD_SHIFT) != 0});
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* window, double, double notches) {
    of(window).pointed_.push_back({.what = Pointed::What::scrolled, .y = notches});
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
    Window& self = of(window);
    self.x_ = x;
    self.y_ = y;
    self.pointed_.push_back({.what = Pointed::What::moved, .x = x, .y = y});
  });
  glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* window, float, float) { of(window).has_letters_ = false; });
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* window) { of(window); });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int, int) { of(window).is_stale_ = true; });
}

Result<void> Window::create_frame() {
  auto pool = compute::CommandPool::create(*device_, "window");
  if (!pool) return pool.take_error();
  pool_ = std::move(*pool);
  auto commands = pool_.allocate("window");
  if (!commands) return commands.take_error();
  commands_ = *commands;
  auto acquired = compute::create_binary_semaphore(*device_, "acquired");
  if (!acquired) return acquired.take_error();
  acquired_ = std::move(*acquired);
  auto fence = compute::create_fence(*device_, "window");
  if (!fence) return fence.take_error();
  fence_ = std::move(*fence);

  VkAttachmentDescription colour{};
  colour.format = format_.format;
  colour.samples = VK_SAMPLE_COUNT_1_BIT;
  colour.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;   // the picture
  colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  colour.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  colour.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  colour.initialLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  colour.finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
  const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &reference;
  VkSubpassDependency after_blit{};
  after_blit.srcSubpass = VK_SUBPASS_EXTERNAL;
  after_blit.srcStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
  after_blit.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  after_blit.dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  after_blit.dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  auto create = typed<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  create.attachmentCount = create.subpassCount = create.dependencyCount = 1;
  create.pAttachments = &colour;
  create.pSubpasses = &subpass;
  create.pDependencies = &after_blit;
  return checked(vkCreateRenderPass(device_->handle(), &create, nullptr, &pass_), "making the interface's render pass");
}

Result<void> Window::create_swapchain() {
  is_stale_ = false;
  VkSurfaceCapabilitiesKHR can{};
  if (auto done = checked(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_->physical(), surface_, &can), "asking the surface"); !done)
    return done;
  size_ = can.currentExtent;
  if (size_.width == std::numeric_limits<std::uint32_t>::max()) {   // the surface takes what it is given
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    size_.width = std::clamp(static_cast<std::uint32_t>(width), can.minImageExtent.width, can.maxImageExtent.width);
    size_.height = std::clamp(static_cast<std::uint32_t>(height), can.minImageExtent.height, can.maxImageExtent.height);
  }
  if (size_.width == 0 || size_.height == 0) return {};   // minimised
  auto create = typed<VkSwapchainCreateInfoKHR>(VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR);
  create.surface = surface_;
  create.minImageCount = std::max(can.minImageCount, can.maxImageCount == 0 ? 3u : std::min(3u, can.maxImageCount));
  create.imageFormat = format_.format;
  create.imageColorSpace = format_.colorSpace;
  create.imageExtent = size_;
  create.imageArrayLayers = 1;
  create.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  create.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
  create.preTransform = can.currentTransform;
  create.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  create.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  create.clipped = VK_TRUE;
  const VkResult created = vkCreateSwapchainKHR(device_->handle(), &create, nullptr, &swapchain_);
  if (auto done = checked(created, "making the swapchain"); !done) return done;
  std::uint32_t count = 0;
  vkGetSwapchainImagesKHR(device_->handle(), swapchain_, &count, nullptr);
  std::vector<VkImage> images(count);
  vkGetSwapchainImagesKHR(device_->handle(), swapchain_, &count, images.data());
  for (const VkImage image : images) {
    Target& target = targets_.emplace_back();
    target.image = image;
    auto view = typed<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
    view.image = image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format_.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    if (auto done = checked(vkCreateImageView(device_->handle(), &view, nullptr, &target.view), "making the window's view"); !done)
      return done;
    auto framebuffer = typed<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
    framebuffer.renderPass = pass_;
    framebuffer.attachmentCount = 1;
    framebuffer.pAttachments = &target.view;
    framebuffer.width = size_.width;
    framebuffer.height = size_.height;
    framebuffer.layers = 1;
    const VkResult made = vkCreateFramebuffer(device_->handle(), &framebuffer, nullptr, &target.framebuffer);
    if (auto done = checked(made, "making the window's framebuffer"); !done) return done;
    auto drawn = compute::create_binary_semaphore(*device_, "drawn");
    if (!drawn) return drawn.take_error();
    target.drawn = std::move(*drawn);
  }
  return {};
}

void Window::destroy_swapchain() {
  device_->wait_idle();   // presenting has no fence
  for (const Target& target : targets_) {
    vkDestroyFramebuffer(device_->handle(), target.framebuffer, nullptr);
    vkDestroyImageView(device_->handle(), target.view, nullptr);
  }
  targets_.clear();
  vkDestroySwapchainKHR(device_->handle(), swapchain_, nullptr);
  swapchain_ = VK_NULL_HANDLE;
}

Window::~Window() {
  if (device_) {
    device_->wait_idle();
    if (has_interface_) {
      if (ImGui::GetIO().BackendRendererUserData != nullptr) ImGui_ImplVulkan_Shutdown();
      ImGui_ImplGlfw_Shutdown();
      ImGui::DestroyContext();
    }
    destroy_swapchain();
    vkDestroyDescriptorPool(device_->handle(), descriptors_, nullptr);
    vkDestroyRenderPass(device_->handle(), pass_, nullptr);
    vkDestroySurfaceKHR(device_->instance(), surface_, nullptr);
  }
  if (window_ != nullptr) glfwDestroyWindow(window_);
  pool_ = {};
  acquired_ = {};
  fence_ = {};
  device_.reset();
  glfwTerminate();
}

bool Window::is_minimised() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return width == 0 || height == 0 || glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE;
}

bool Window::wants_to_close() const { return glfwWindowShouldClose(window_) == GLFW_TRUE; }
void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void Window::poll(double seconds) {
  if (seconds > 0) glfwWaitEventsTimeout(seconds);
  else glfwPollEvents();
}

std::vector<Pointed> Window::take_pointed() { return std::exchange(pointed_, {}); }

std::vector<Key> Window::take_keys() { return std::exchange(keys_, {}); }

std::vector<std::filesystem::path> Window::take_dropped() { return std::exchange(dropped_, {}); }

Result<void> Window::wait() {
  if (!is_under_way_) return {};
  is_under_way_ = false;
  return compute::wait_for(*device_, fence_.get());
}

Result<std::optional<VkCommandBuffer>> Window::begin() {
  if (auto done = wait(); !done) return done.take_error();
  if (is_minimised()) return std::optional<VkCommandBuffer>();
  if (!has_letters_)
    if (auto done = create_letters(); !done) return done.take_error();
  if (is_stale_ || swapchain_ == VK_NULL_HANDLE) {
    destroy_swapchain();
    if (auto done = create_swapchain(); !done) return done.take_error();
    if (swapchain_ == VK_NULL_HANDLE) return std::optional<VkCommandBuffer>();
  }
  const VkResult acquired = vkAcquireNextImageKHR(device_->handle(), swapchain_, std::numeric_limits<std::uint64_t>::max(),
                                                  acquired_.get(), VK_NULL_HANDLE, &target_);
  if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
    is_stale_ = true;
    return std::optional<VkCommandBuffer>();
  }
  if (acquired == VK_SUBOPTIMAL_KHR) is_stale_ = true;   // its picture can still be shown
  else if (auto done = checked(acquired, "acquiring a picture of the window"); !done) return done.take_error();
  auto begin = typed<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  if (auto done = checked(vkBeginCommandBuffer(commands_, &begin), "beginning a frame"); !done) return done.take_error();
  ImGui_ImplVulkan_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  return std::optional(commands_);
}

Result<void> Window::finish(VkImage picture, VkExtent2D extent) {
  Target& target = targets_[target_];
  change_layout(commands_, target.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  VkImageBlit whole{};
  whole.srcSubresource = whole.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  whole.srcOffsets[1] = {static_cast<std::int32_t>(extent.width), static_cast<std::int32_t>(extent.height), 1};
  whole.dstOffsets[1] = {static_cast<std::int32_t>(size_.width), static_cast<std::int32_t>(size_.height), 1};
  vkCmdBlitImage(commands_, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole,
                 VK_FILTER_LINEAR);
  auto begin = typed<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
  begin.renderPass = pass_;
  begin.framebuffer = target.framebuffer;
  begin.renderArea = {{0, 0}, size_};
  vkCmdBeginRenderPass(commands_, &begin, VK_SUBPASS_CONTENTS_INLINE);
  ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands_);
  vkCmdEndRenderPass(commands_);
  if (auto done = checked(vkEndCommandBuffer(commands_), "ending a frame"); !done) return done;

  const auto start = std::chrono::steady_clock::now();
  const VkFence fence = fence_.get();
  if (auto done = checked(vkResetFences(device_->handle(), 1, &fence), "resetting the window's fence"); !done) return done;
  auto buffer = typed<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
  buffer.commandBuffer = commands_;
  auto wait = typed<VkSemaphoreSubmitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO);
  wait.semaphore = acquired_.get();
  wait.stageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  auto signal = typed<VkSemaphoreSubmitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO);
  signal.semaphore = target.drawn.get();
  signal.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  auto submit = typed<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  submit.waitSemaphoreInfoCount = submit.commandBufferInfoCount = submit.signalSemaphoreInfoCount = 1;
  submit.pWaitSemaphoreInfos = &wait;
  submit.pCommandBufferInfos = &buffer;
  submit.pSignalSemaphoreInfos = &signal;
  if (auto done = device_->submit(submit, fence); !done) return done;
  is_under_way_ = true;
  const VkSemaphore drawn = target.drawn.get();
  auto present = typed<VkPresentInfoKHR>(VK_STRUCTURE_TYPE_PRESENT_INFO_KHR);
  present.waitSemaphoreCount = present.swapchainCount = 1;
  present.pWaitSemaphores = &drawn;
  present.pSwapchains = &swapchain_;
  present.pImageIndices = &target_;
  const VkResult presented = device_->present(present);
  if (presented == VK_ERROR_OUT_OF_DATE_KHR || presented == VK_SUBOPTIMAL_KHR) is_stale_ = true;
  else if (auto done = checked(presented, "presenting"); !done) return done;
  if (auto done = this->wait(); !done) return done;
  drawn_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return {};
}

}  // namespace weft::view
