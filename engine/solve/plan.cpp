// The order of the passes, their specialisation, and what they touch.
#include "engine/solve/plan.h"

#include <algorithm>

#include "compute/contraction.h"
#include "engine/effects/tear/tear.h"
#include "shaders/embedded.h"

namespace weft {
namespace {

const Slice* slice_named(std::string_view name) {
  for (const Effect* effect : all_effects())
    if (effect->slice.name == name) return &effect->slice;
  return nullptr;
}

// The name of a block or of a texel buffer is its row's name and an ending. Empty where the ending is another.
std::string_view without_ending(std::string_view name, std::string_view ending) {
  return name.ends_with(ending) ? name.substr(0, name.size() - ending.size()) : std::string_view();
}

std::vector<const Pass*> passes_of(const Needs& needs) {
  std::vector<const Pass*> passes;
  for (std::size_t k = 0; k < kEffects; ++k) {
    if (!needs.effects[k]) continue;
    for (const Pass& pass : all_effects()[k]->passes)
      if (pass.when == nullptr || pass.when(needs)) passes.push_back(&pass);
  }
  std::stable_sort(passes.begin(), passes.end(), [](const Pass* a, const Pass* b) { return a->stage < b->stage; });
  return passes;
}

// A pass of the frame, and which parts of motion/finalize.glsl are its.
struct Part {
  const Pass* pass;
  bool holds_tethers = false, finalizes = false;
};

bool is_own_finalizer(const Pass& pass) { return std::string_view(pass.name) == "finalize"; }

// All passes. The last pass of an iteration finalizes it, if it can; the pass `finalize` exists only where it cannot. Tethers belong to
// that too, unless the last pass comes after them: then they end the one before it, or a `finalize` for them alone.
std::vector<Part> parts_of(const std::vector<const Pass*>& passes, const Needs& needs) {
  std::vector<Part> parts;
  const auto own = std::ranges::find_if(passes, [](const Pass* pass) { return is_own_finalizer(*pass); });
  bool holds_tethers = !needs.has(EffectId::tether);
  const auto end_in = [&](bool Part::*what) {
    if (parts.back().pass->stage != Stage::iteration || !parts.back().pass->can_finalize) parts.push_back({*own});
    parts.back().*what = true;
  };
  for (const Pass* pass : passes) {
    const bool ends = is_own_finalizer(*pass);   // the last of its stage, by the order of effects
    if (!holds_tethers && (ends || pass->after_tethers)) {
      end_in(&Part::holds_tethers);
      holds_tethers = true;
    }
    if (ends)
      end_in(&Part::finalizes);
    else
      parts.push_back({pass});
  }
  return parts;
}

std::string label_of(const Part& part, const Needs& needs) {
  std::string label = part.pass->name;
  if (needs.has(EffectId::contact)) label += part.pass->with_contacts;
  if (part.pass->collides && needs.has(EffectId::collide)) label += "+collide";
  for (std::size_t k = 0; k < kEffects; ++k) {
    const bool is_part = EffectId(k) == EffectId::tether ? part.holds_tethers : part.finalizes;
    if (needs.effects[k] && is_part) label += all_effects()[k]->part_of_finalize;
  }
  if (part.finalizes && !is_own_finalizer(*part.pass)) label += "+finalize";
  return label;
}

Result<PlannedPass::Resource> resource_of(const compute::Binding& binding, Plan& plan) {
  if (const std::string_view name = without_ending(binding.name, "_slice"); !name.empty()) {
    const Slice* slice = slice_named(name);
    if (slice == nullptr) return fail("no effect tells a slice ", name);
    auto at = std::find(plan.slices.begin(), plan.slices.end(), slice);
    if (at == plan.slices.end()) at = plan.slices.insert(at, slice);
    return PlannedPass::Resource{binding, PlannedPass::Resource::Kind::slice, static_cast<std::size_t>(at - plan.slices.begin())};
  }
  const bool texels = binding.set == WEFT_TEXEL_SET;
  const Buffer* row = buffer_named(without_ending(binding.name, texels ? "_texels" : "_block"));
  if (row == nullptr) return fail("no effect has a row for the buffer of ", binding.name);
  if (!texels && binding.element_bytes != row->element_bytes)
    return fail("its elements of ", row->name, " have ", binding.element_bytes, " bytes, not ", row->element_bytes);
  if (texels && row->texel == Texel::none) return fail(row->name, " has elements that no texel buffer holds");
  const Buffer& memory = row->lies_in != nullptr ? *row->lies_in : *row;
  if (texels && row->texel != memory.texel) return fail(row->name, " lies in ", memory.name, ", whose texels are others");
  const std::size_t number = number_of(memory);
  auto at =
      std::find_if(plan.buffers.begin(), plan.buffers.end(), [&](const Plan::PlannedBuffer& b) { return number_of(*b.row) >= number; });
  if (at == plan.buffers.end() || at->row != &memory) at = plan.buffers.insert(at, {&memory});
  (!texels ? at->storage : binding.kind == compute::Binding::Kind::storage_texel_buffer ? at->shared_texels : at->texels) = true;
  return PlannedPass::Resource{binding, PlannedPass::Resource::Kind::buffer, number};
}

Result<PlannedPass> planned(const Part& part, const Needs& needs, compute::Specializer& specializer, Plan& plan) {
  const Pass& pass = *part.pass;
  PlannedPass made;
  made.pass = &pass;
  made.label = label_of(part, needs);
  made.finalizes = part.finalizes || part.holds_tethers;
  const auto refuse = [&](const std::string& why) { return fail("pass ", made.label, ": ", why); };
  const auto module = shader(pass.name);
  if (module.empty()) return refuse("there is no shader of this name");
  std::vector<compute::SpecializationConstant> constants;
  for (std::uint32_t id = 0; id < needs.constants.size(); ++id) constants.push_back({id, needs.constants[id]});
  constants[gpu::constant::finalizes].value = part.finalizes;
  std::uint32_t& width = constants[gpu::constant::workgroup].value;
  if (pass.a_workgroup_each) width = needs.narrow;
  if (pass.thin) width = needs.thin;
  if (pass.alone) width = pass.crew ? needs.crew : needs.alone;
  if (!part.holds_tethers) constants[gpu::constant::tether_pairs].value = 0;
  const auto spirv = specializer.specialize(module, constants);
  if (!spirv) return refuse(spirv.error());
  // Passes that do the same in another way, or in workgroups of another width, must get the same bits.
  made.spirv = compute::without_contraction(*spirv);
  const auto touched = compute::reflect(made.spirv);
  if (!touched) return refuse(touched.error());
  if (touched->local_size[0] != width || touched->push_constant_bytes > sizeof(gpu::Push))
    return refuse("its workgroup's width is its own or its push block is longer than " + std::to_string(sizeof(gpu::Push)) + " bytes");
  for (const compute::Binding& binding : touched->bindings) {
    auto resource = resource_of(binding, plan);
    if (!resource) return refuse(resource.error());
    if (resource->kind == PlannedPass::Resource::Kind::buffer) {
      if (binding.read) made.reads.insert(resource->number);
      if (binding.written) made.writes.insert(resource->number);
    }
    made.resources.push_back(std::move(*resource));
  }
  return made;
}

}  // namespace

const Plan::PlannedBuffer* Plan::find(const Buffer& row) const {
  const auto at = std::find_if(buffers.begin(), buffers.end(), [&](const PlannedBuffer& b) { return b.row == &row; });
  return at == buffers.end() ? nullptr : &*at;
}

Result<Plan> make_plan(const Needs& needs, compute::Specializer& specializer) {
  Plan plan;
  for (const Part& part : parts_of(passes_of(needs), needs)) {
    auto made = planned(part, needs, specializer, plan);
    if (!made) return made.take_error();
    plan.passes.push_back(std::move(*made));
  }
  return plan;
}

std::uint64_t bytes_of(const Buffer& row, const Cooked& subject) {
  return std::max<std::uint64_t>(1, row.length(subject)) * row.element_bytes;
}

std::uint64_t room_of(const Buffer& row, const Cooked& subject) {
  const std::uint64_t bytes = bytes_of(row, subject);
  const bool may_be_longer = !row.grows && row.lifetime != Lifetime::persistent && row.access != Access::vertices && row.length(subject) > 1;
  if (!may_be_longer || !tears(subject.scene)) return bytes;
  constexpr std::uint64_t kLeast = 4096;
  const std::uint64_t most = row.most != nullptr ? row.most(subject) * row.element_bytes : 2 * bytes;
  return std::max(most, kLeast / row.element_bytes * row.element_bytes);
}

std::vector<Range> ranges_of(const Pass& pass, const Cooked& subject) {
  if (pass.ranges != nullptr) return pass.ranges(subject);
  return std::vector<Range>(pass.rounds, {0, static_cast<std::uint32_t>(pass.threads.count(subject))});
}

}  // namespace weft
