// The table of passes decides everything: for every combination of features, which passes, shaders and buffers there are.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "engine/passes.h"
#include "shaders/embedded.h"

namespace weft {
namespace {

// What the method jacobi can have.
constexpr std::uint32_t kLinks = feature::kAnchors | feature::kBending | feature::kTethers | feature::kColliders | feature::kIterated | feature::kContacts;

// Every combination that a scene can call for (scene_method.cpp).
std::vector<std::uint32_t> combinations() {
  using namespace feature;
  std::vector<std::uint32_t> found;
  for (std::uint32_t features = 0; features <= kLinks; ++features) {
    found.push_back(features);
    found.push_back(features | kGaussSeidel);
    found.push_back(features | kHinges);
    found.push_back(features | kGaussSeidel | kHinges);
    if ((features & (kIterated | kContacts | kTethers)) == kIterated) found.push_back(features | kChebyshev);
    if ((features & (kIterated | kBending)) != 0) continue;   // links and bends: not of the method implicit
    found.push_back(features | kSprings);
    found.push_back(features | kImplicit);
    found.push_back(features | kImplicit | kRelaxed);
  }
  return found;
}

template <class Body>
void for_every_plan(Body body) {
  for (const std::uint32_t features : combinations())
    for (const bool gather_storage : {false, true}) {
      SCOPED_TRACE("features " + std::to_string(features) + (gather_storage ? ", storage" : ", texels"));
      const auto plan = make_plan(features, gather_storage);
      ASSERT_TRUE(plan) << plan.error();
      body(*plan, features, gather_storage);
    }
}

std::vector<std::string> labels(std::uint32_t features) {
  std::vector<std::string> found;
  const auto plan = make_plan(features, false);
  EXPECT_TRUE(plan) << plan.error();
  if (plan)
    for (const PlannedPass& planned : plan->passes) found.push_back(planned.label);
  return found;
}

bool has(const Plan& plan, gpu::Binding binding) { return plan.buffers() >> binding & 1; }

TEST(Plan, exactly_one_pass_settles_and_it_is_the_last_of_its_iteration) {
  for_every_plan([](const Plan& plan, std::uint32_t features, bool) {
    std::vector<const PlannedPass*> iteration;
    for (const PlannedPass& planned : plan.passes)
      if (planned.pass->stage == Stage::iteration) iteration.push_back(&planned);
    ASSERT_FALSE(iteration.empty());
    EXPECT_TRUE(iteration.back()->pass->settles && iteration.back()->pass->relaxes);
    const bool something = features & (feature::kTethers | feature::kColliders) || !(features & feature::kContacts);
    for (const PlannedPass* planned : iteration)
      EXPECT_EQ(planned->label != planned->pass->name, planned == iteration.back() && something) << planned->label;
  });
}

TEST(Plan, contacts_end_their_substeps_in_a_pass_of_their_own) {
  for_every_plan([](const Plan& plan, std::uint32_t features, bool) {
    const bool contacts = features & feature::kContacts;
    EXPECT_EQ(std::count_if(plan.passes.begin(), plan.passes.end(), [](const PlannedPass& p) { return p.label == "settle"; }), contacts ? 1 : 0);
    // Velocities are written by what ends a substep, and by the first prediction.
    int writers = 0;
    for (const PlannedPass& planned : plan.passes) writers += (planned.writes >> gpu::velocities & 1) != 0;
    EXPECT_EQ(writers, 2);
  });
}

TEST(Plan, stages_come_in_their_order) {
  for_every_plan([](const Plan& plan, std::uint32_t features, bool) {
    EXPECT_TRUE(std::is_sorted(plan.passes.begin(), plan.passes.end(), [](const PlannedPass& a, const PlannedPass& b) { return a.pass->stage < b.pass->stage; }));
    EXPECT_EQ(plan.passes.front().label, features & feature::kContacts ? "predict+watch" : "predict");
    EXPECT_EQ(plan.passes.back().label, "surface");
  });
}

TEST(Plan, its_buffers_are_what_its_passes_touch) {
  for_every_plan([](const Plan& plan, std::uint32_t, bool gather_storage) {
    std::uint64_t touched = 0;
    for (const PlannedPass& planned : plan.passes) {
      EXPECT_NE(planned.writes, 0u) << planned.label << " has no effect";
      touched |= planned.reads | planned.writes;
    }
    EXPECT_EQ(plan.buffers(), touched);
    if (gather_storage) { EXPECT_EQ(plan.texels, 0u); }
  });
}

TEST(Plan, whatever_a_pass_writes_for_others_is_read) {
  // For the renderer and the host alone; the other iterate is read in the next pass, under the other name.
  constexpr std::uint64_t kOutputs = 1ull << gpu::vertex_positions | 1ull << gpu::vertex_normals | 1ull << gpu::counters | 1ull << gpu::relaxed;   // and arguments of dispatches
  for_every_plan([](const Plan& plan, std::uint32_t, bool) {
    std::uint64_t reads = 0, writes = 0;
    for (const PlannedPass& planned : plan.passes) {
      reads |= planned.reads;
      writes |= planned.writes;
    }
    EXPECT_EQ(writes & ~reads & ~kOutputs, 0u);
  });
}

TEST(Plan, both_variants_touch_the_same_buffers_in_the_same_way) {
  for (const std::uint32_t features : combinations()) {
    const auto texels = make_plan(features, false), storage = make_plan(features, true);
    ASSERT_TRUE(texels && storage);
    ASSERT_EQ(texels->passes.size(), storage->passes.size());
    for (std::size_t k = 0; k < texels->passes.size(); ++k) {
      EXPECT_EQ(texels->passes[k].label, storage->passes[k].label);
      EXPECT_EQ(texels->passes[k].reads, storage->passes[k].reads) << features << " " << texels->passes[k].label;
      EXPECT_EQ(texels->passes[k].writes, storage->passes[k].writes) << features << " " << texels->passes[k].label;
    }
  }
}

TEST(Plan, no_pass_of_a_feature_that_is_off_is_in_it_and_every_row_of_the_table_is_in_one) {
  std::set<const Pass*> used;
  for_every_plan([&](const Plan& plan, std::uint32_t features, bool) {
    for (const PlannedPass& planned : plan.passes) {
      used.insert(planned.pass);
      EXPECT_EQ(planned.pass->needs & ~features, 0u) << planned.label;
      EXPECT_EQ(planned.pass->without & features, 0u) << planned.label;
    }
  });
  EXPECT_EQ(used.size(), all_passes().size());
}

TEST(Plan, every_buffer_of_a_feature_is_there_with_it_and_absent_without) {
  for_every_plan([](const Plan& plan, std::uint32_t features, bool) {
    const bool implicit = features & feature::kImplicit, relaxed = features & feature::kRelaxed;
    const bool bending = !implicit && (features & feature::kBending), iterated = !implicit && (features & feature::kIterated);
    EXPECT_EQ(has(plan, gpu::anchors), (features & feature::kAnchors) != 0);
    EXPECT_EQ(has(plan, gpu::tethers), (features & feature::kTethers) != 0);
    EXPECT_EQ(has(plan, gpu::colliders), (features & feature::kColliders) != 0);
    const bool explicit_springs = features & feature::kSprings, coloured = features & feature::kGaussSeidel, accelerated = features & feature::kChebyshev;
    EXPECT_EQ(has(plan, gpu::stretch_lambda), iterated && !coloured);
    EXPECT_EQ(has(plan, gpu::coloured_links), coloured);
    EXPECT_EQ(has(plan, gpu::coloured_lambda), coloured && iterated);
    for (const gpu::Binding steps : {gpu::stretch_steps, gpu::iterates, gpu::acceleration}) EXPECT_EQ(has(plan, steps), accelerated) << steps;
    EXPECT_EQ(has(plan, gpu::bend_steps), accelerated && bending);
    for (const gpu::Binding once : {gpu::bend_rows, gpu::bend_entries}) EXPECT_EQ(has(plan, once), bending && !iterated) << once;
    for (const gpu::Binding often : {gpu::bends, gpu::bend_lambda, gpu::bend_impulses, gpu::bend_uses, gpu::bend_use_rows})
      EXPECT_EQ(has(plan, often), bending && iterated) << often;
    for (const gpu::Binding hinges : {gpu::hinges, gpu::hinge_impulses, gpu::hinge_uses, gpu::hinge_use_rows})
      EXPECT_EQ(has(plan, hinges), (features & feature::kHinges) != 0) << hinges;
    for (const gpu::Binding links : {gpu::stretch_rows, gpu::stretch_links}) EXPECT_EQ(has(plan, links), !implicit && !explicit_springs && !coloured) << links;
    for (const gpu::Binding springs : {gpu::spring_rows, gpu::spring_ends, gpu::springs}) EXPECT_EQ(has(plan, springs), implicit || explicit_springs) << springs;
    for (const gpu::Binding springs : {gpu::spring_blocks, gpu::inverses, gpu::exchanged, gpu::krylov,
                                       gpu::partial_sums, gpu::linear, gpu::free_cloths})
      EXPECT_EQ(has(plan, springs), implicit) << springs;
    EXPECT_EQ(has(plan, gpu::walls), implicit && (features & feature::kColliders) != 0);
    EXPECT_EQ(std::any_of(plan.passes.begin(), plan.passes.end(), [](const PlannedPass& p) { return p.label == "implicit_relax"; }), implicit && relaxed);
    EXPECT_EQ(std::any_of(plan.passes.begin(), plan.passes.end(), [](const PlannedPass& p) { return p.label == "implicit_multiply"; }), implicit && !relaxed);
    for (const gpu::Binding always : {gpu::positions, gpu::velocities, gpu::predicted, gpu::relaxed, gpu::materials,
                                      gpu::surface_rows, gpu::corners, gpu::vertex_positions, gpu::vertex_normals, gpu::counters})
      EXPECT_TRUE(has(plan, always)) << always;
  });
}

TEST(Plan, labels_name_what_a_dispatch_does) {
  using namespace feature;
  using Labels = std::vector<std::string>;
  EXPECT_EQ(labels(kPlain), (Labels{"predict", "stretch+settle", "surface"}));
  EXPECT_EQ(labels(kBending | kTethers), (Labels{"predict", "stretch", "bend+tether+settle", "surface"}));
  EXPECT_EQ(labels(kLinks & ~kIterated & ~kContacts), (Labels{"predict", "anchor", "stretch", "bend+tether+collide+settle", "surface"}));
  EXPECT_EQ(labels(kImplicit | kTethers), (Labels{"predict", "implicit_assemble", "implicit_multiply", "implicit_advance", "implicit_drift", "implicit_step+tether+settle",
                                                  "surface"}));
  EXPECT_EQ(labels(kImplicit | kRelaxed), (Labels{"predict", "implicit_assemble", "implicit_relax", "implicit_drift", "implicit_step+settle", "surface"}));
  EXPECT_EQ(labels(kImplicit | kColliders), (Labels{"predict", "implicit_assemble", "implicit_meet", "implicit_multiply", "implicit_advance", "implicit_drift",
                                                    "implicit_step+collide+settle", "surface"}));
  EXPECT_EQ(labels(kColliders | kIterated), (Labels{"predict", "stretch+collide+settle", "surface"}));
  EXPECT_EQ(labels(kLinks & ~kContacts), (Labels{"predict", "anchor", "stretch", "bend_lambda", "bend_gather+tether+collide+settle", "surface"}));
  EXPECT_EQ(labels(kSprings | kTethers), (Labels{"predict", "spring", "hold+tether+settle", "surface"}));
  EXPECT_EQ(labels(kGaussSeidel), (Labels{"predict", "stretch", "hold+settle", "surface"}));
  EXPECT_EQ(labels(kGaussSeidel | kBending), (Labels{"predict", "stretch", "bend+settle", "surface"}));
  EXPECT_EQ(labels(kHinges | kTethers), (Labels{"predict", "stretch", "hinge", "hinge_gather+tether+settle", "surface"}));
  EXPECT_EQ(labels(kHinges | kBending), (Labels{"predict", "stretch", "bend", "hinge", "hinge_gather+settle", "surface"}));
  EXPECT_EQ(labels(kGaussSeidel | kHinges), (Labels{"predict", "stretch", "hinge", "hinge_gather+settle", "surface"}));
  EXPECT_EQ(labels(kChebyshev | kIterated | kBending | kColliders),
            (Labels{"predict", "stretch", "bend_lambda", "bend_gather", "accelerate+collide+settle", "surface"}));
  EXPECT_EQ(labels(kContacts), (Labels{"predict+watch", "detect_arm", "detect_path", "grid_count", "grid_total", "grid_scan", "grid_fill", "search_faces", "search_edges",
                                       "search_arm", "pair_faces", "pair_edges", "contact_arm", "contact_prepare", "stretch", "contact_weigh", "contact_solve", "contact_apply", "contact_open", "contact_limit", "settle", "surface"}));
  EXPECT_EQ(labels(kLinks & ~kIterated),
            (Labels{"predict+watch", "anchor+watch", "detect_arm", "detect_path", "grid_count", "grid_total", "grid_scan", "grid_fill", "search_faces", "search_edges",
                    "search_arm", "pair_faces", "pair_edges", "contact_arm", "contact_prepare", "stretch", "bend+tether+collide", "contact_weigh", "contact_solve", "contact_apply+collide", "contact_open", "contact_limit", "settle", "surface"}));
}

TEST(Plan, every_shader_of_the_table_exists_in_both_variants) {
  constexpr const char* kFused[] = {"+settle", "+tether+settle", "+collide+settle", "+tether+collide+settle", "", "+tether", "+collide", "+tether+collide"};
  const std::set<std::string> no_gathers = {"anchor", "detect_arm", "grid_total", "grid_scan", "search_arm", "contact_arm"};
  const auto expect = [&](const std::string& name) {
    EXPECT_FALSE(shader(name).empty()) << name;
    // What does not gather has one variant that is right for both.
    if (!no_gathers.contains(name)) { EXPECT_FALSE(shader(name + ".storage").empty()) << name; }
  };
  for (const Pass& pass : all_passes()) {
    if (!pass.settles) expect(pass.shader), expect(std::string(pass.shader) + pass.fused);
    else
      for (const char* fused : kFused) expect(std::string(pass.shader) + fused);
  }
}

// Small cloths with and without each feature.
struct Subject {
  Scene scene;
  CookedFabric fabric;
};

Subject subject(std::uint32_t features) {
  Subject made;
  Cloth& cloth = made.scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, 5, 4, Topology::diagonal, true};
  cloth.bending = features & feature::kBending;
  cloth.tethers = features & feature::kTethers;
  if (features & feature::kHinges) {
    made.scene.cloths.push_back(made.scene.cloths[0]);
    made.scene.cloths[1].bending = true;
    made.scene.cloths[1].bend_rest = BendRest::mesh;
  }
  if (features & feature::kAnchors) {
    Cloth& cloth = made.scene.cloths[0];
    cloth.anchors.resize(1);
    cloth.anchors[0].top = 0;
  }
  if (features & feature::kColliders) made.scene.colliders.resize(3);
  made.scene.contacts.enabled = features & feature::kContacts;
  made.scene.solver.iterations = features & feature::kIterated ? 2 : 1;
  made.scene.solver.method = features & feature::kImplicit ? Method::implicit : Method::jacobi;
  made.scene.solver.linear = features & feature::kRelaxed ? Linear::jacobi : Linear::cg;
  if (features & feature::kGaussSeidel) made.scene.solver.method = Method::gauss_seidel;
  if (features & feature::kSprings) made.scene.solver.method = Method::mass_spring;
  if (features & feature::kChebyshev) made.scene.solver.method = Method::chebyshev;
  const auto meshes = make_meshes(made.scene);
  auto fabric = cook(made.scene, *meshes);
  EXPECT_TRUE(fabric) << fabric.error();
  if (fabric) made.fabric = std::move(*fabric);
  return made;
}

TEST(Features, a_scene_calls_for_what_it_has) {
  for (const std::uint32_t features : combinations()) {
    // Tethers need an anchor to hold on to.
    if ((features & feature::kTethers) && !(features & feature::kAnchors)) continue;
    const Subject s = subject(features);
    EXPECT_EQ(features_of(s.scene, s.fabric), features);
  }
  const Subject unheld = subject(feature::kTethers);
  EXPECT_EQ(features_of(unheld.scene, unheld.fabric), feature::kPlain);
}

TEST(BufferNeeds, every_buffer_of_the_plan_has_bytes_and_no_other_is_listed) {
  for (const std::uint32_t features : combinations()) {
    const Subject s = subject(features);
    const auto plan = make_plan(features_of(s.scene, s.fabric), false);
    ASSERT_TRUE(plan) << plan.error();
    std::uint64_t listed = 0;
    for (const BufferNeed& need : buffer_needs(*plan, s.scene, s.fabric, contact_sizes(s.scene, s.fabric))) {
      listed |= 1ull << need.binding;
      EXPECT_GT(need.bytes, 0u) << need.name;
      if (plan->texels >> need.binding & 1) { EXPECT_NE(need.texel, BufferNeed::Texel::none) << need.name; }
    }
    EXPECT_EQ(listed, plan->buffers());
  }
}

TEST(BufferNeeds, sizes_are_those_of_the_cooked_arrays) {
  const Subject s = subject(kLinks);
  const auto plan = make_plan(kLinks, false);
  ASSERT_TRUE(plan) << plan.error();
  const auto bytes = [&](gpu::Binding binding) {
    for (const BufferNeed& need : buffer_needs(*plan, s.scene, s.fabric, contact_sizes(s.scene, s.fabric)))
      if (need.binding == binding) return need.bytes;
    return std::uint64_t(0);
  };
  EXPECT_EQ(bytes(gpu::positions), 30 * 16u);
  EXPECT_EQ(bytes(gpu::stretch_links), s.fabric.stretch.pairs.size() * 16);
  EXPECT_EQ(bytes(gpu::stretch_lambda), s.fabric.stretch.pairs.size() * 8);
  EXPECT_EQ(bytes(gpu::bends), s.fabric.bends.size() * 40);
  EXPECT_EQ(bytes(gpu::bend_uses), s.fabric.bend_uses.pairs.size() * 16);
  EXPECT_EQ(bytes(gpu::tethers), 30 * 4 * 8u);
  EXPECT_EQ(bytes(gpu::anchors), 6 * 28u);
  EXPECT_EQ(bytes(gpu::colliders), 3 * sizeof(gpu::Collider));
  EXPECT_EQ(bytes(gpu::counters), sizeof(gpu::Counters));
  EXPECT_EQ(bytes(gpu::triangles), s.fabric.triangles.size() * 16);
  EXPECT_EQ(bytes(gpu::edges), s.fabric.edges.size() * 8);
  EXPECT_EQ(bytes(gpu::candidates), contact_sizes(s.scene, s.fabric).capacity * std::uint64_t(16));
}

TEST(DomainSize, threads_are_counted_by_domain) {
  const Subject s = subject(kLinks);
  const ContactSizes sizes = contact_sizes(s.scene, s.fabric);
  EXPECT_EQ(domain_size(Domain::particles, s.fabric, sizes), 30u);
  EXPECT_EQ(domain_size(Domain::anchors, s.fabric, sizes), 6u);
  EXPECT_EQ(domain_size(Domain::bends, s.fabric, sizes), s.fabric.bends.size());
  EXPECT_EQ(domain_size(Domain::vertices, s.fabric, sizes), 30u);
}

}  // namespace
}  // namespace weft
