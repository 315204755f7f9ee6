// A lock around Godot's Vulkan queues, for all who submit to them.
//
// Godot uploads what its loader threads load by submits of theirs. Where a device has no queue family for transfers alone these go to the
// queue that Godot draws on, which is also Weft's. Godot keeps its own submits apart by a lock inside its driver, which it does not lend.
// So this plug-in brings a lock of its own, as a Vulkan layer that lies in this very library: below Godot and below Weft, it lets one
// thread at a time use a queue.
//
// A layer has to be named before Vulkan's instance is made. Godot opens plug-ins that it knows of before that; one that it meets while it
// runs, as the editor does with a new one, has its lock with the next start.
//
// Interface: LoaderLayerInterface.md of the Vulkan loader, version 2. It takes a loader that knows VK_ADD_LAYER_PATH (1.3.207, of 2022).
#pragma once

namespace weft_godot {

/// Names the layer to the loader, by a manifest in a folder of its own and by the environment of this process. Where that cannot be,
/// nothing happens: there is no lock then.
void name_queue_lock();
/// Once there is an instance, or none to come: puts the environment back, and removes the manifest.
void forget_queue_lock();

}  // namespace weft_godot
