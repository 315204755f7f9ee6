// Meshes as files that other programs open: PLY for a look at strain, OBJ and GLB for a cloth in its moved pose.
//
// They are written under a temporary name beside the target and renamed when complete, so a full disk or a read-only folder
// never leaves half a file under the name that was asked for.
#pragma once

#include <filesystem>
#include <span>

#include "compute/result.h"
#include "engine/mesh.h"

namespace weft {

/// Binary little-endian PLY: x y z [nx ny nz] [strain] per vertex (float), triangles as lists of three ints.
/// `normals` and `strain` (a fraction) are as many as the positions, or none, and are then left out of the file.
/// Errors: lists of unequal length, an index out of range, a file that cannot be written (no folder, no permission, a full disk, a
/// target that is no regular file).
Result<void> write_ply(const std::filesystem::path& file, std::span<const Vec3> positions, std::span<const Vec3> normals,
                       std::span<const float> strain, std::span<const Triangle> triangles);

/// OBJ: a v, vt and vn line a vertex, numbers that are read back as the same bits; v of a texture coordinate grows upwards there.
/// Normals and UVs are as many as the positions, or none. Errors: as write_ply.
Result<void> write_obj(const std::filesystem::path& file, std::span<const Vec3> positions, std::span<const Vec3> normals,
                       std::span<const Vec2> uvs, std::span<const Triangle> triangles);

/// GLB (glTF 2.0): one node, one mesh, with a primitive for each of its materials, which keep their textures; one that is double-sided for
/// triangles without any; positions, normals, UVs, 32-bit indices. Triangles lie by their materials, each of these in their order.
/// Tangents are not written: a reader makes them from the UVs. Normals and UVs are as many as the positions, or none.
/// Errors: as write_ply; also a material that is not there, no triangle at all, which glTF does not allow, and more than 4 GiB, which a
/// GLB does not hold.
Result<void> write_glb(const std::filesystem::path& file, const RenderMesh& mesh);

}  // namespace weft
