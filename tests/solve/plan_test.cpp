// The declarations of effects decide everything: for every combination that a scene can call for, which passes, code and buffers there are.
#include "engine/solve/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <spirv-tools/libspirv.hpp>
#include <string>

#include "engine/effects/buffers.h"
#include "shaders/embedded.h"
#include "tests/support/calls.h"

namespace weft {
namespace {

std::vector<std::string> labels(const Calls& calls) {
  std::vector<std::string> found;
  for (const PlannedPass& planned : plan_for(calls).passes) found.push_back(planned.label);
  return found;
}

TEST(Plan, exactly_one_pass_finalizes_and_it_is_the_last_of_its_iteration) {
  for_every_plan([](const Plan& plan, const Calls& calls, bool) {
    std::vector<const PlannedPass*> iteration;
    for (const PlannedPass& planned : plan.passes)
      if (planned.pass->stage == Stage::iteration) iteration.push_back(&planned);
    ASSERT_FALSE(iteration.empty());
    EXPECT_TRUE(iteration.back()->pass->can_finalize && iteration.back()->pass->changes == Changes::iterate);
    const bool alone = std::string(iteration.back()->pass->name) == "finalize";
    const bool ends_in_tethers = calls.has(Id::tether) && !calls.has(Id::triangle);
    const bool something = ends_in_tethers || calls.has(Id::collide) || calls.has(Id::motion_constraint) || !alone;
    // Tethers end the constraints, before triangles collide; nothing else is a part of another pass than the last.
    int with_tethers = 0;
    for (const PlannedPass* planned : iteration) {
      const bool holds = planned->label.find("+tether") != std::string::npos;
      with_tethers += holds;
      EXPECT_TRUE(!holds || (planned == iteration.back()) == !calls.has(Id::triangle)) << planned->label;
      EXPECT_EQ(planned->label != planned->pass->name, holds || (planned == iteration.back() && something)) << planned->label;
    }
    EXPECT_EQ(with_tethers, calls.has(Id::tether));
  });
}

TEST(Plan, velocities_change_in_free_flight_by_forces_and_where_a_substep_ends_and_nowhere_else) {
  for_every_plan([](const Plan& plan, const Calls& calls, bool) {
    int enders = 0;
    for (const PlannedPass& planned : plan.passes) {
      const bool ends = planned.label.ends_with("finalize") || planned.label.starts_with("finalize");
      const bool may = planned.pass->stage == Stage::frame_begin || planned.pass->changes == Changes::velocity || ends;
      EXPECT_TRUE(may || planned.pass->can_end_substep || !planned.writes.contains(number_of(buffers::velocities))) << planned.label;
      if (planned.pass->changes == Changes::velocity) { EXPECT_EQ(planned.pass->stage, Stage::force); }
      enders += planned.pass->stage > Stage::force && planned.writes.contains(number_of(buffers::velocities));
    }
    // For particles that have candidates contact_finalize; or contact_alone, where idle threads cost nothing.
    const int of_contacts = calls.has(Id::tether) ? 1 : 2;   // calls.h
    EXPECT_EQ(enders, calls.has(Id::contact) ? 1 + of_contacts : 1);
    EXPECT_EQ(std::any_of(plan.passes.begin(), plan.passes.end(), [](const PlannedPass& p) { return p.label == "contact_finalize"; }),
              calls.has(Id::contact));
  });
}

TEST(Plan, stages_come_in_their_order) {
  for_every_plan([](const Plan& plan, const Calls& calls, bool) {
    EXPECT_TRUE(std::is_sorted(plan.passes.begin(), plan.passes.end(),
                               [](const PlannedPass& a, const PlannedPass& b) { return a.pass->stage < b.pass->stage; }));
    EXPECT_EQ(plan.passes.front().label, calls.has(Id::shift)     ? (calls.has(Id::strand) ? "shift_strands" : "shift_patches")
                                         : calls.has(Id::inertia) ? "inertia" : calls.has(Id::contact) ? "predict+watch" : "predict");
    EXPECT_EQ(plan.passes.back().label, calls.has(Id::render_mesh) ? "render_mesh" : "surface");
  });
}

TEST(Plan, its_buffers_are_what_its_passes_touch) {
  for_every_plan([](const Plan& plan, const Calls&, bool texels) {
    compute::IndexSet touched, listed;
    for (const PlannedPass& planned : plan.passes) {
      EXPECT_FALSE(planned.writes.empty()) << planned.label << " has no effect";
      touched.insert(planned.reads);
      touched.insert(planned.writes);
    }
    for (const Plan::PlannedBuffer& planned : plan.buffers) {
      listed.insert(number_of(*planned.row));
      if (!texels) { EXPECT_FALSE(planned.texels) << planned.row->name; }
    }
    EXPECT_EQ(listed, touched);
  });
}

TEST(Plan, whatever_a_pass_writes_for_others_is_read) {
  // For the renderer and the host alone; the other iterate is read in the next pass, under the other name.
  const std::set<const Buffer*> outputs = {&buffers::vertex_positions, &buffers::vertex_normals, &buffers::counters,
                                           &buffers::next_iterate};
  for_every_plan([&](const Plan& plan, const Calls&, bool) {
    compute::IndexSet reads;
    for (const PlannedPass& planned : plan.passes) reads.insert(planned.reads);
    for (const PlannedPass& planned : plan.passes)
      for (const Plan::PlannedBuffer& buffer : plan.buffers)
        if (planned.writes.contains(number_of(*buffer.row)) && !outputs.contains(buffer.row)) {
          EXPECT_TRUE(reads.contains(number_of(*buffer.row))) << planned.label << " writes " << buffer.row->name;
        }
  });
}

TEST(Plan, gathers_touch_the_same_buffers_in_the_same_way_through_texels_and_through_storage) {
  for (const Calls& calls : all_combinations()) {
    const Plan &texels = plan_for(calls, true), &storage = plan_for(calls, false);
    ASSERT_EQ(texels.passes.size(), storage.passes.size());
    for (std::size_t k = 0; k < texels.passes.size(); ++k) {
      EXPECT_EQ(texels.passes[k].label, storage.passes[k].label);
      EXPECT_EQ(texels.passes[k].reads, storage.passes[k].reads) << words(calls) << texels.passes[k].label;
      EXPECT_EQ(texels.passes[k].writes, storage.passes[k].writes) << words(calls) << texels.passes[k].label;
    }
  }
}

TEST(Plan, no_pass_of_an_effect_that_is_not_called_for_is_in_it_and_every_pass_there_is_is_in_one) {
  std::set<std::string> used, declared;
  for (const Effect* effect : all_effects())
    for (const Pass& pass : effect->passes) declared.insert(pass.name);
  for_every_plan([&](const Plan& plan, const Calls& calls, bool texels) {
    const Needs setup = setup_for(calls, texels);
    std::set<const Pass*> allowed;
    for (std::size_t k = 0; k < kEffects; ++k)
      if (setup.effects[k])
        for (const Pass& pass : all_effects()[k]->passes) allowed.insert(&pass);
    for (const PlannedPass& planned : plan.passes) {
      used.insert(planned.pass->name);
      EXPECT_TRUE(allowed.contains(planned.pass)) << planned.label;
    }
  });
  EXPECT_EQ(used, declared);
}

TEST(Plan, every_pass_is_one_module_and_nothing_of_it_is_left_open) {
  std::set<std::string> names;
  for (const Effect* effect : all_effects())
    for (const Pass& pass : effect->passes) {
      EXPECT_FALSE(shader(pass.name).empty()) << pass.name;
      EXPECT_TRUE(names.insert(pass.name).second) << pass.name << " is declared twice";
    }
  for_every_plan([](const Plan& plan, const Calls&, bool) {
    for (const PlannedPass& planned : plan.passes) {
      const auto touched = compute::reflect(planned.spirv);
      ASSERT_TRUE(touched) << touched.error();
      EXPECT_TRUE(touched->spec_constants.empty()) << planned.label;
      const Pass& pass = *planned.pass;
      EXPECT_EQ(touched->local_size[0],
                pass.a_workgroup_each ? kNarrow : pass.thin ? kThin : pass.crew ? kCrew : pass.alone ? kAlone : kWorkgroup) << planned.label;
    }
  });
}

// The oldest that a host may lend: SPIR-V 1.3, no capability that a feature enables, and the layouts of blocks that need none.
TEST(Plan, every_pass_is_valid_on_a_device_of_vulkan_1_1_without_features) {
  spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_1);
  std::string said;
  tools.SetMessageConsumer([&](spv_message_level_t, const char*, const spv_position_t&, const char* text) { said += text; });
  std::set<std::vector<std::uint32_t>> seen;
  std::ptrdiff_t most_shared = 0, most_buffers = 0, most_of_seldom = 0, most_of_seldom_in_storage = 0;   // of seldom only where the device binds so many
  for_every_plan([&](const Plan& plan, const Calls&, bool texels) {
    for (const PlannedPass& planned : plan.passes) {
      const auto is_storage = [](const PlannedPass::Resource& r) { return r.binding.kind == compute::Binding::Kind::storage_buffer; };
      const auto is_shared = [](const PlannedPass::Resource& r) { return r.binding.kind == compute::Binding::Kind::storage_texel_buffer; };
      most_shared = std::max(most_shared, std::ranges::count_if(planned.resources, is_shared));
      const Crowd crowd = planned.pass->crowd;
      std::ptrdiff_t& most = planned.pass->when != nullptr && crowd != Crowd::any ? most_of_seldom : most_buffers;
      const std::ptrdiff_t takes = std::ranges::count_if(planned.resources, is_storage);
      if (texels) most = std::max(most, takes);
      else if (&most == &most_of_seldom) most_of_seldom_in_storage = std::max(most_of_seldom_in_storage, takes);
      if (!seen.insert(std::vector<std::uint32_t>(planned.spirv.begin(), planned.spirv.end())).second) continue;
      EXPECT_TRUE(tools.Validate(planned.spirv.data(), planned.spirv.size())) << planned.label << ": " << said;
    }
  });
  EXPECT_GT(seen.size(), 50u);
  EXPECT_EQ(most_shared, 4) << "Vulkan grants a stage no more storage texel buffers";
  EXPECT_EQ(most_buffers, 15) << "engine/README.md says so";
  EXPECT_EQ(most_of_seldom, 18) << "and so do contact.cpp and it";
  EXPECT_EQ(most_of_seldom_in_storage, 28) << "contact.cpp says so";
}

TEST(Plan, code_shrinks_with_what_a_scene_leaves_out) {
  const auto words_of = [](const Calls& calls) {
    for (const PlannedPass& planned : plan_for(calls).passes)
      if (std::string(planned.pass->name) == "stretch") return planned.spirv.size();
    return std::size_t(0);
  };
  const std::size_t plain = words_of({{Id::stretch}});
  EXPECT_LT(plain, words_of({{Id::stretch, Id::tether}}));
  EXPECT_LT(plain, words_of({{Id::stretch, Id::collide}}));
  EXPECT_LT(plain, words_of({{Id::stretch}, true}));
  EXPECT_GT(plain, words_of({{Id::stretch, Id::bend}})) << "there the bends finalize";
}

TEST(Plan, every_buffer_of_an_effect_is_there_with_it_and_absent_without) {
  for_every_plan([](const Plan& plan, const Calls& calls, bool) {
    const auto expect = [&](bool wanted, std::initializer_list<const Buffer*> rows) {
      for (const Buffer* row : rows) EXPECT_EQ(plan.has(*row), wanted) << row->name;
    };
    const bool implicit = calls.has(Id::implicit), bending = calls.has(Id::bend), patches = calls.has(Id::gauss_seidel), levels = calls.has(Id::level),
               strands = calls.has(Id::strand),
               accelerated = calls.has(Id::chebyshev);
    namespace b = buffers;
    expect(calls.has(Id::anchor), {&b::anchors});
    expect(calls.has(Id::tether), {&b::tethers});
    expect(calls.has(Id::collide), {&b::colliders});
    expect(calls.has(Id::stretch), {&b::stretch_rows, &b::stretch_links});
    expect(calls.has(Id::stretch) && calls.iterated, {&b::stretch_lambda});
    expect(levels, {&b::level_nodes, &b::level_gathers, &b::level_node_shares, &b::level_ends, &b::level_shares});
    expect(levels && !implicit, {&b::level_links, &b::level_centres, &b::level_middles, &b::level_carried, &b::level_steps});
    expect(levels && implicit, {&b::level_grips, &b::level_residuals, &b::level_blocks, &b::level_changes});
    expect(levels && calls.iterated, {&b::level_lambda});
    expect(calls.has(Id::support), {&b::supports});
    expect(calls.has(Id::support) && calls.has(Id::reaction), {&b::support_bodies});
    expect(calls.has(Id::support) && levels && !calls.has(Id::reaction), {&b::level_supports});
    expect(strands, {&b::strand_starts, &b::strand_links});
    expect(strands && calls.iterated, {&b::strand_lambda});
    expect(patches, {&b::patches, &b::patch_members, &b::patch_colour_ends, &b::patch_links});
    expect(patches && calls.iterated, {&b::patch_lambda});
    expect(patches && calls.has(Id::shift), {&b::patch_shifted, &b::patch_shifts});
    expect(strands && calls.has(Id::shift), {&b::strand_shifted, &b::strand_shifts, &b::stretch_shifted, &b::stretch_shifts});
    expect(accelerated, {&b::stretch_steps, &b::chebyshev_iterates, &b::acceleration});
    expect(accelerated && bending, {&b::bend_steps});
    expect(bending && !calls.iterated, {&b::bend_rows, &b::bend_entries});
    expect(bending && calls.iterated, {&b::bends, &b::bend_lambda, &b::bend_impulses, &b::bend_uses, &b::bend_use_rows});
    expect(calls.has(Id::dihedral), {&b::hinges, &b::hinge_impulses, &b::hinge_uses, &b::hinge_use_rows});
    expect(calls.has(Id::spring), {&b::spring_rows, &b::spring_ends, &b::springs});
    expect(implicit, {&b::spring_blocks, &b::inverses, &b::exchanged, &b::solve_vectors, &b::partial_sums, &b::linear, &b::free_cloths});
    expect(implicit && calls.has(Id::collide), {&b::collider_filters});
    expect(calls.has(Id::triangle) || (calls.has(Id::air) && calls.has(Id::collide)), {&b::triangles});
    expect(calls.has(Id::triangle), {&b::collisions, &b::collision_list, &b::collision_sums, &b::collision_depths});
    expect(calls.has(Id::triangle) && calls.has(Id::contact), {&b::ways_out});
    expect(calls.has(Id::contact),
           {&b::clusters, &b::cluster_faces, &b::cluster_edges, &b::cluster_searchers, &b::cluster_hulls, &b::memberships, &b::cluster_surroundings,
            &b::clusters_around, &b::cluster_boxes, &b::cluster_pushes, &b::near_bounds, &b::cluster_motions, &b::smooth_clusters,
            &b::near_clusters, &b::near_boxes,
            &b::outlines, &b::outline_boxes, &b::rest, &b::detected_positions, &b::trajectories, &b::displacement_bounds, &b::grid_counts,
            &b::grid_starts, &b::grid_entries, &b::detection, &b::candidates, &b::contact_normals, &b::contact_weights,
            &b::contact_counts, &b::contact_sums, &b::contact_penetrations, &b::slides, &b::kinematic_lags, &b::step_fractions, &b::contact_list,
            &b::touched_particles});
    expect(calls.has(Id::air), {&b::air_rows, &b::air_fans});
    expect(calls.has(Id::air) && calls.has(Id::collide), {&b::wake_bodies, &b::wakes});
    expect(calls.has(Id::pressure),
           {&b::gases, &b::gas_parts, &b::gas_rows, &b::gas_rings, &b::gas_amounts, &b::gas_states, &b::gas_gradients, &b::gas_sums});
    expect(calls.has(Id::skin), {&b::skin_points, &b::skin_joints});
    expect(calls.has(Id::skin) && calls.has(Id::contact), {&b::morph_rows, &b::morph_deltas, &b::morph_weights, &b::target_rows, &b::skin_sources, &b::host_targets, &b::skin_ends});
    expect(calls.has(Id::skin) && calls.has(Id::contact) && calls.has(Id::motion_constraint), {&b::morph_normals, &b::host_normals});
    expect(calls.has(Id::motion_constraint), {&b::motion_targets, &b::motion_limits});
    expect(calls.has(Id::grab), {&b::grabs});
    expect(calls.has(Id::grab) && calls.has(Id::reaction), {&b::last_pulls});
    expect(calls.has(Id::inertia), {&b::frame_changes});
    expect(calls.has(Id::render_mesh), {&b::carried});
    expect(calls.has(Id::untangle), {&b::tangled_pairs, &b::crossed_triangles, &b::regions, &b::region_sizes});
    expect(true, {&b::positions, &b::velocities, &b::predicted, &b::next_iterate, &b::materials, &b::surface_rows, &b::corners,
                  &b::vertex_positions, &b::vertex_normals, &b::counters});
  });
}

TEST(Plan, rows_of_links_that_all_have_one_length_need_no_buffer_that_tells) {
  Needs setup = setup_for({{Id::stretch}}, true);
  setup.constants[constant::stretch_stride] = 6;
  const auto plan = make_plan(setup, specializer());
  ASSERT_TRUE(plan) << plan.error();
  EXPECT_FALSE(plan->has(buffers::stretch_rows));
  EXPECT_TRUE(plan->has(buffers::stretch_links));
}

TEST(Plan, labels_name_what_a_dispatch_does) {
  using Labels = std::vector<std::string>;
  const Calls all{{Id::anchor, Id::stretch, Id::bend, Id::tether, Id::collide}};
  EXPECT_EQ(labels({{Id::stretch}}), (Labels{"predict", "stretch+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::bend, Id::tether}}), (Labels{"predict", "stretch", "bend+tether+finalize", "surface"}));
  EXPECT_EQ(labels(all), (Labels{"predict", "anchor", "stretch", "bend+tether+collide+finalize", "surface"}));
  EXPECT_EQ(labels({all.effects, true}),
            (Labels{"predict", "anchor", "stretch", "bend_lambda", "bend_gather+tether+collide+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::spring, Id::implicit, Id::tether}}),
            (Labels{"predict", "implicit_assemble", "implicit_multiply", "implicit_advance", "implicit_drift",
                    "implicit_step+tether+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::spring, Id::implicit, Id::level}}),
            (Labels{"predict", "implicit_assemble", "implicit_multiply", "implicit_advance", "implicit_mean", "implicit_mean_wide", "implicit_low",
                    "implicit_wide", "implicit_spread", "implicit_drift", "implicit_step+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::spring, Id::implicit}, false, true}),
            (Labels{"predict", "implicit_assemble", "implicit_relax", "implicit_drift", "implicit_step+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::spring, Id::implicit, Id::collide}}),
            (Labels{"predict", "implicit_assemble", "implicit_filter", "implicit_multiply", "implicit_advance", "implicit_drift",
                    "implicit_step+collide+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::collide}, true}), (Labels{"predict", "stretch+collide+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::spring, Id::tether}}), (Labels{"predict", "spring", "finalize+tether", "surface"}));
  EXPECT_EQ(labels({{Id::gauss_seidel}}), (Labels{"predict", "gauss_seidel", "finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::level}}), (Labels{"predict", "level_centre", "level_centre_wide", "level_low", "level_wide", "level_spread", "stretch+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::strand}}), (Labels{"predict", "strand", "stretch+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::strand, Id::level, Id::bend}}),
            (Labels{"predict", "level_centre", "level_centre_wide", "level_low", "level_wide", "strand", "stretch", "bend+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::gauss_seidel, Id::level}}),
            (Labels{"predict", "level_centre", "level_centre_wide", "level_low", "level_wide", "level_spread", "gauss_seidel", "finalize", "surface"}));
  EXPECT_EQ(labels({{Id::gauss_seidel, Id::shift}}), (Labels{"shift_patches", "predict", "gauss_seidel", "finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::strand, Id::shift}}),
            (Labels{"shift_strands", "shift_stretch", "predict", "strand", "stretch+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::gauss_seidel, Id::bend}}), (Labels{"predict", "gauss_seidel", "bend+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::dihedral, Id::tether}}),
            (Labels{"predict", "stretch", "dihedral", "dihedral_gather+tether+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::dihedral, Id::bend}}),
            (Labels{"predict", "stretch", "bend", "dihedral", "dihedral_gather+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::gauss_seidel, Id::dihedral}}),
            (Labels{"predict", "gauss_seidel", "dihedral", "dihedral_gather+finalize", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::chebyshev, Id::bend, Id::collide}, true}),
            (Labels{"predict", "stretch", "bend_lambda", "bend_gather", "chebyshev+collide+finalize", "surface"}));
  EXPECT_EQ(labels(with(all, {Id::triangle})), (Labels{"predict", "anchor", "stretch", "bend+tether", "triangle_search", "triangle_collide",
                                                       "finalize+collide", "surface"}));
  EXPECT_EQ(labels({{Id::gauss_seidel, Id::tether, Id::collide, Id::triangle}}),
            (Labels{"predict", "gauss_seidel", "finalize+tether", "triangle_search", "triangle_collide", "finalize+collide", "surface"}));
  EXPECT_EQ(labels({{Id::stretch, Id::contact}}),
            (Labels{"predict+watch", "detect_alone", "detect_arguments", "detect_track", "cluster_box", "grid_fill", "grid_search",
                    "detect_outline", "detect_search", "detect_pair", "detect_prepare", "contact_prepare", "stretch+finalize",
                    "contact_alone", "contact_penetration", "contact_solve", "contact_apply", "contact_slide", "contact_slide_apply",
                    "contact_unsafe", "contact_limit", "contact_limit_rest", "contact_finalize", "surface"}));
  // With tethers, where idle threads cost (calls.h).
  EXPECT_EQ(labels(with(all, {Id::contact})),
            (Labels{"predict+watch", "anchor+watch", "detect_arguments", "detect_track", "cluster_box", "grid_fill", "grid_search",
                    "outline_particles", "outline_faces", "outline_edges", "search_faces", "search_edges", "search_rare", "pair_faces",
                    "pair_edges", "contact_prepare", "stretch",
                    "bend+tether+collide+finalize", "contact_alone+collide", "contact_penetration", "contact_solve",
                    "contact_apply+collide", "contact_slide", "contact_slide_apply", "contact_unsafe", "contact_limit", "contact_limit_rest",
                    "contact_finalize", "surface"}));
  const std::vector<std::string> untangled = labels({{Id::stretch, Id::contact, Id::untangle}});
  EXPECT_EQ(untangled.size(), labels({{Id::stretch, Id::contact}}).size() + 1);
  EXPECT_EQ(*(std::ranges::find(untangled, "untangle") - 1), "contact_prepare");
}

}  // namespace
}  // namespace weft
