// The order of the passes, their specialisation, and what they touch.
#include "engine/solve/plan.h"

#include <algorithm>

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

bool is_own_finalizer(const Pass& pass) { return std::string_view(pass.name) == "finalize"; }

// The last pass of an iteration finalizes it, if it can; the pass `finalize` exists only for iterations that have no other pass, or
// whose last pass cannot.
const Pass* finalizer_of(std::vector<const Pass*>& passes) {
  const auto changes = [](const Pass* pass) { return pass->stage == Stage::iteration && !is_own_finalizer(*pass); };
  const auto last = std::find_if(passes.rbegin(), passes.rend(), changes);
  if (last != passes.rend() && (*last)->can_finalize) {
    const Pass* finalizer = *last;
    std::erase_if(passes, [](const Pass* pass) { return is_own_finalizer(*pass); });
    return finalizer;
  }
  const auto own = std::find_if(passes.begin(), passes.end(), [](const Pass* pass) { return is_own_finalizer(*pass); });
  return own == passes.end() ? nullptr : *own;
}

std::string label_of(const Pass& pass, bool finalizes, const Needs& needs) {
  std::string label = pass.name;
  if (needs.has(EffectId::contact)) label += pass.with_contacts;
  if (pass.collides && needs.has(EffectId::collide)) label += "+collide";
  if (!finalizes) return label;
  for (std::size_t k = 0; k < kEffects; ++k)
    if (needs.effects[k]) label += all_effects()[k]->part_of_finalize;
  if (!needs.has(EffectId::contact) && !is_own_finalizer(pass)) label += "+finalize";
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
  const std::size_t number = number_of(memory);
  auto at =
      std::find_if(plan.buffers.begin(), plan.buffers.end(), [&](const Plan::PlannedBuffer& b) { return number_of(*b.row) >= number; });
  if (at == plan.buffers.end() || at->row != &memory) at = plan.buffers.insert(at, {&memory});
  (texels ? at->texels : at->storage) = true;
  return PlannedPass::Resource{binding, PlannedPass::Resource::Kind::buffer, number};
}

Result<PlannedPass> planned(const Pass& pass, bool finalizes, const Needs& needs, compute::Specializer& specializer, Plan& plan) {
  PlannedPass made;
  made.pass = &pass;
  made.label = label_of(pass, finalizes, needs);
  const auto refuse = [&](const std::string& why) { return fail("pass ", made.label, ": ", why); };
  const auto module = shader(pass.name);
  if (module.empty()) return refuse("there is no shader of this name");
  std::vector<compute::SpecializationConstant> constants;
  for (std::uint32_t id = 0; id < needs.constants.size(); ++id) constants.push_back({id, needs.constants[id]});
  constants[gpu::constant::finalizes].value = finalizes;
  const auto spirv = specializer.specialize(module, constants);
  if (!spirv) return refuse(spirv.error());
  made.spirv.assign(spirv->begin(), spirv->end());
  const auto touched = compute::reflect(made.spirv);
  if (!touched) return refuse(touched.error());
  if (touched->local_size[0] != needs.constants[gpu::constant::workgroup] || touched->push_constant_bytes > sizeof(gpu::Push))
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
  std::vector<const Pass*> passes = passes_of(needs);
  const Pass* finalizer = finalizer_of(passes);
  for (const Pass* pass : passes) {
    auto made = planned(*pass, pass == finalizer, needs, specializer, plan);
    if (!made) return made.take_error();
    plan.passes.push_back(std::move(*made));
  }
  return plan;
}

std::uint64_t bytes_of(const Buffer& row, const Cooked& subject) {
  return std::max<std::uint64_t>(1, row.length(subject)) * row.element_bytes;
}

std::vector<Range> ranges_of(const Pass& pass, const Cooked& subject) {
  if (pass.ranges != nullptr) return pass.ranges(subject);
  return std::vector<Range>(pass.rounds, {0, static_cast<std::uint32_t>(pass.threads.count(subject))});
}

}  // namespace weft
