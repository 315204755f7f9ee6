// What a cooked scene calls for, and from it the lengths and contents of buffers and the threads of passes.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "engine/effects/buffers.h"
#include "engine/figures.h"
#include "tests/support/calls.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

TEST(Buffers, names_are_one_row_each_and_every_row_is_one_that_passes_touch) {
  std::set<std::string_view> names;
  for (const Buffer* row : all_buffers()) {
    EXPECT_TRUE(names.insert(row->name).second) << row->name << " has two rows";
    EXPECT_NE(row->length, nullptr) << row->name;
    EXPECT_EQ(buffer_named(row->name), row);
  }
  std::set<const Buffer*> touched;
  for_every_plan([&](const Plan& plan, const Calls&, bool) {
    for (const Plan::PlannedBuffer& planned : plan.buffers) touched.insert(planned.row);
  });
  for (const Buffer* row : all_buffers()) EXPECT_TRUE(touched.contains(row->lies_in != nullptr ? row->lies_in : row)) << row->name;
}

// Small cloths with and without each effect.
struct Sheet {
  Scene scene = without_contacts();
  CookedFabric fabric;
  Cooked subject() const { return cooked_of(scene, fabric); }
};

Sheet sheet_for(const Calls& calls) {
  Sheet made;
  Cloth& cloth = made.scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, 5, 4, Topology::diagonal, true};
  if (calls.has(Id::level)) cloth.grid->cells_x = 9;   // enough for one
  if (calls.has(Id::support)) cloth.grid->cells_x = cloth.grid->cells_y = 52;
  cloth.bending = calls.has(Id::bend);
  cloth.tethers = calls.has(Id::tether);
  if (calls.has(Id::dihedral)) {
    made.scene.cloths.push_back(made.scene.cloths[0]);
    made.scene.cloths[1].bending = true;
    made.scene.cloths[1].bend_rest = BendRest::mesh;
  }
  if (calls.has(Id::anchor)) {
    made.scene.cloths[0].anchors.resize(1);
    made.scene.cloths[0].anchors[0].top = 0;
  }
  if (calls.has(Id::skin)) made.scene.cloths[0].skin.emplace();
  if (calls.has(Id::motion_constraint)) made.scene.cloths[0].motion_constraints.emplace().backstop_radius = 1;
  if (calls.has(Id::collide)) made.scene.colliders.resize(3);
  made.scene.reactions = calls.has(Id::reaction);
  if (calls.has(Id::support)) {   // one that is thin for the sheet, and not for its cells
    made.scene.colliders[0].shape = ColliderShape::sphere;
    made.scene.colliders[0].radius = 0.1;
  }
  if (calls.has(Id::triangle)) made.scene.colliders[0].shape = ColliderShape::box;
  made.scene.contacts.enabled = calls.has(Id::contact);
  made.scene.contacts.untangle = calls.has(Id::untangle);
  made.scene.solver.iterations = calls.iterated ? 2 : 1;
  made.scene.solver.linear = calls.relaxed ? Linear::jacobi : Linear::cg;
  made.scene.solver.method = calls.has(Id::implicit)       ? Method::implicit
                             : calls.has(Id::gauss_seidel) ? Method::gauss_seidel
                             : calls.has(Id::spring)       ? Method::mass_spring
                             : calls.has(Id::chebyshev)    ? Method::chebyshev
                             : calls.has(Id::strand)       ? Method::strands
                                                           : Method::jacobi;
  made.scene.solver.levels = calls.has(Id::level);
  made.scene.solver.shifts = calls.has(Id::shift);
  made.scene.solver.order = calls.has(Id::bdf2) ? 2 : 1;
  const auto meshes = make_meshes(made.scene);
  auto fabric = cook(made.scene, *meshes);
  EXPECT_TRUE(fabric) << fabric.error();
  if (fabric) made.fabric = std::move(*fabric);
  return made;
}

TEST(NeedsOf, a_scene_calls_for_what_it_has) {
  for (const Calls& calls : combinations()) {
    // Tethers need an anchor to hold on to.
    if (calls.has(Id::tether) && !calls.has(Id::anchor)) continue;
    SCOPED_TRACE(words(calls));
    const Sheet sheet = sheet_for(calls);
    const Needs wanted = setup_for(calls, true), got = needs_of(sheet.subject(), kWorkgroup, true);
    EXPECT_EQ(got.effects, wanted.effects);
    for (const auto id : {constant::workgroup, constant::through_texels, constant::is_iterated, constant::is_accelerated,
                          constant::has_levels, constant::has_colliders, constant::triangles_collide, constant::has_contacts, constant::untangles,
                          constant::is_second_order,
                          constant::motion_constraints, constant::skins_move_anchors})
      EXPECT_EQ(got.constants[id], wanted.constants[id]) << "constant " << id;
    EXPECT_EQ(got.constants[constant::planes], calls.has(Id::triangle) || calls.has(Id::support) ? 2u : calls.has(Id::collide) ? 3u : 0u);
  }
  const Sheet unheld = sheet_for({{Id::stretch, Id::tether}});
  EXPECT_FALSE(needs_of(unheld.subject(), kWorkgroup, true).has(Id::tether));
}

TEST(NeedsOf, fine_cloth_over_a_thin_collider_calls_for_supports) {
  const Sheet fine = sheet_for({{Id::stretch, Id::collide, Id::support}});
  EXPECT_TRUE(needs_of(fine.subject(), kWorkgroup, true).has(Id::support));
  const Sheet coarse = sheet_for({{Id::stretch, Id::collide}});
  EXPECT_FALSE(needs_of(coarse.subject(), kWorkgroup, true).has(Id::support));
}

TEST(Buffers, every_buffer_of_a_plan_has_bytes) {
  for (const Calls& calls : combinations()) {
    if (calls.has(Id::tether) && !calls.has(Id::anchor)) continue;
    const Sheet sheet = sheet_for(calls);
    const auto plan = make_plan(needs_of(sheet.subject(), kWorkgroup, true), specializer());
    ASSERT_TRUE(plan) << plan.error();
    for (const Plan::PlannedBuffer& planned : plan->buffers) {
      EXPECT_GT(bytes_of(*planned.row, sheet.subject()), 0u) << planned.row->name;
      if (planned.texels) { EXPECT_NE(planned.row->texel, Texel::none) << planned.row->name; }
    }
  }
}

TEST(Buffers, sizes_and_contents_are_those_of_the_cooked_arrays) {
  const Sheet sheet = sheet_for({{Id::anchor, Id::stretch, Id::bend, Id::tether, Id::collide, Id::contact}, true});
  const Cooked subject = sheet.subject();
  const auto bytes = [&](const Buffer& row) { return bytes_of(row, subject); };
  EXPECT_EQ(bytes(buffers::positions), 30 * 16u);
  EXPECT_EQ(bytes(buffers::stretch_links), sheet.fabric.stretch.pairs.size() * 16);
  EXPECT_EQ(bytes(buffers::stretch_lambda), sheet.fabric.stretch.pairs.size() * 8);
  EXPECT_EQ(bytes(buffers::bends), sheet.fabric.bends.size() * 40);
  EXPECT_EQ(bytes(buffers::bend_uses), sheet.fabric.bend_uses.pairs.size() * 16);
  EXPECT_EQ(bytes(buffers::tethers), 30 * 4 * 8u);
  EXPECT_EQ(bytes(buffers::anchors), 6 * 28u);
  EXPECT_EQ(bytes(buffers::colliders), 3 * sizeof(gpu::Collider));
  EXPECT_EQ(bytes(buffers::counters), sizeof(gpu::Counters));
  EXPECT_EQ(bytes(buffers::triangles), sheet.fabric.triangles.size() * 16);
  EXPECT_EQ(bytes(buffers::cluster_faces), sheet.fabric.triangles.size() * 16);
  EXPECT_EQ(bytes(buffers::cluster_edges), sheet.fabric.edges.size() * 16);
  EXPECT_EQ(bytes(buffers::candidates), subject.contacts.capacity * std::uint64_t(16));
  EXPECT_EQ(bytes(buffers::near_edges), bytes(buffers::contact_normals)) << "they lie there";
  EXPECT_EQ(bytes(buffers::near_faces), bytes(buffers::contact_weights));
  for (const Buffer* row : all_buffers())
    if (row->contents != nullptr && row->lifetime == Lifetime::cooked) {
      EXPECT_EQ(row->contents(subject).bytes().size(), row->length(subject) * row->element_bytes) << row->name;
    }
}

TEST(Figures, every_effect_reports_under_names_of_its_own) {
  std::set<std::string_view> names;
  for (const Effect* effect : all_effects())
    for (const Figure& figure : effect->figures) {
      EXPECT_TRUE(names.insert(figure.name).second) << figure.name;
      EXPECT_EQ((figure.cooked != nullptr) + (figure.counted != nullptr) + (figure.measured != nullptr), 1) << figure.name;
    }
}

TEST(Figures, a_scene_reports_what_it_calls_for_and_nothing_else) {
  const auto names = [](const std::vector<FigureValue>& figures) {
    std::set<std::string_view> found;
    for (const FigureValue& figure : figures) found.insert(figure.name);
    return found;
  };
  const Sheet hung = sheet_for({{Id::anchor, Id::stretch, Id::bend, Id::tether}});
  EXPECT_EQ(names(cooked_figures(hung.scene, hung.fabric)), (std::set<std::string_view>{"anchored", "bends", "tethers"}));
  EXPECT_EQ(summary_of(hung.scene, hung.fabric),
            "30 particles, " + std::to_string(hung.fabric.links.size()) + " edges, 6 anchored, " +
                std::to_string(hung.fabric.bends.size()) + " bends, " + std::to_string(hung.fabric.tether_count) + " tethers");
  EXPECT_TRUE(counted_figures(hung.scene, hung.fabric, {}).empty());
  EXPECT_TRUE(remarks_on(hung.scene, hung.fabric, {}).empty());

  const Sheet touching = sheet_for({{Id::stretch, Id::contact}});
  Counts counts;
  counts.contacts_most = 7;
  counts.tracking_error = 0.002f;
  const auto figures = counted_figures(touching.scene, touching.fabric, counts);
  EXPECT_EQ(names(figures), (std::set<std::string_view>{"contacts.max", "contacts.room", "contacts.overflowed", "contacts.truncated",
                                                        "contacts.detections", "contacts.tracking_error"}));
  EXPECT_EQ(std::get<std::uint64_t>(figures[0].value), 7u);
  const auto remarks = remarks_on(touching.scene, touching.fabric, counts);
  ASSERT_EQ(remarks.size(), 2u);
  EXPECT_NE(remarks[0].find("up to 7 pairs"), std::string::npos);
  EXPECT_NE(remarks[1].find("2 mm behind"), std::string::npos);
}

TEST(Passes, threads_are_counted_from_what_was_cooked) {
  const Sheet sheet = sheet_for({{Id::anchor, Id::stretch, Id::bend, Id::contact}, true});
  std::map<std::string, std::uint32_t> threads;
  std::map<std::string, std::size_t> dispatches;
  for (const Effect* effect : all_effects())
    for (const Pass& pass : effect->passes) {
      const auto ranges = ranges_of(pass, sheet.subject());
      dispatches[pass.name] = ranges.size();
      if (!ranges.empty()) threads[pass.name] = ranges.front().count;
    }
  EXPECT_EQ(threads["predict"], 30u);
  EXPECT_EQ(threads["anchor"], 6u);
  EXPECT_EQ(threads["bend_lambda"], sheet.fabric.bends.size());
  EXPECT_EQ(threads["surface"], 30u);
  EXPECT_EQ(threads["contact_alone"], 30u);
  EXPECT_EQ(dispatches["contact_limit"], std::size_t(WEFT_WIDE_ROUNDS));
  EXPECT_EQ(dispatches["contact_limit_rest"], 1u);
  const Sheet patched = sheet_for({{Id::gauss_seidel}});
  for (const Pass& pass : effect(Id::gauss_seidel).passes)
    EXPECT_EQ(ranges_of(pass, patched.subject()).size(), patched.fabric.own.of<PatchLists>().rounds.size());
}

}  // namespace
}  // namespace weft
