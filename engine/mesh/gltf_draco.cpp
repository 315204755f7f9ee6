// Draco (KHR_draco_mesh_compression). Its decoder believes what a stream says of itself, so it has a process with bounds to its memory and
// time, by what the document says must come out.
#include "engine/mesh/apart.h"
#include "engine/mesh/gltf.h"

#ifdef WEFT_DRACO
#include <draco/compression/decode.h>
#endif

namespace weft::parts {

std::uint64_t DracoMesh::size() const {
  std::uint64_t bytes = corners * sizeof(std::uint32_t);
  for (const Attribute& attribute : attributes) bytes += vertices * attribute.size();
  return bytes;
}

#ifdef WEFT_DRACO
namespace {

draco::DataType type_of(std::uint64_t component) {
  switch (component) {
    case 5120: return draco::DT_INT8;
    case 5121: return draco::DT_UINT8;
    case 5122: return draco::DT_INT16;
    case 5123: return draco::DT_UINT16;
    case 5125: return draco::DT_UINT32;
    case 5126: return draco::DT_FLOAT32;
    default: return draco::DT_INVALID;
  }
}

Result<void> add_unpacked(const DracoMesh& wanted, std::string& all) {
  draco::DecoderBuffer stream;
  stream.Init(wanted.bytes.data(), wanted.bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&stream);
  if (!decoded.ok()) return fail("Draco says: ", decoded.status().error_msg_string());
  const draco::Mesh& mesh = *decoded.value();
  if (mesh.num_points() != wanted.vertices || std::uint64_t{3} * mesh.num_faces() != wanted.corners)
    return fail("its stream has ", mesh.num_points(), " vertices and ", mesh.num_faces(), " triangles, and the document says ",
                wanted.vertices, " and ", wanted.corners / 3);
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& corner : mesh.face(f)) {
      const std::uint32_t index = corner.value();
      all.append(reinterpret_cast<const char*>(&index), sizeof index);
    }
  for (const DracoMesh::Attribute& attribute : wanted.attributes) {
    const bool is_id = attribute.id < kNone;
    const draco::PointAttribute* from = is_id ? mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(attribute.id)) : nullptr;
    if (!from) return fail("its stream has no attribute ", attribute.id);
    if (from->data_type() != type_of(attribute.component) || static_cast<std::size_t>(from->num_components()) != attribute.width ||
        static_cast<std::size_t>(from->byte_stride()) != attribute.size())
      return fail("attribute ", attribute.id, " of its stream has ", int{from->num_components()},
                  " numbers of another type than the document says");
    for (draco::PointIndex p(0); p < mesh.num_points(); ++p) {
      const draco::AttributeValueIndex at = from->mapped_index(p);
      if (at.value() >= from->size()) return fail("attribute ", attribute.id, " of its stream lacks vertex ", p.value());
      all.append(reinterpret_cast<const char*>(from->GetAddress(at)), attribute.size());
    }
  }
  return {};
}

}  // namespace

Result<std::string> unpack_draco(std::span<const DracoMesh> meshes, std::uint64_t total) {
  std::uint64_t packed = 0;
  for (const DracoMesh& mesh : meshes) packed += mesh.bytes.size();
  const Bounds bounds{static_cast<std::size_t>((std::uint64_t{256} << 20) + 16 * total + 4 * packed),
                      static_cast<unsigned>(3 + (total + packed) / (1 << 20))};
  return apart("Draco", bounds, [&]() -> Result<std::string> {
    std::string all;
    for (const DracoMesh& mesh : meshes)
      if (Result<void> added = add_unpacked(mesh, all); !added) return added.take_error();
    return all;
  });
}
#else
Result<std::string> unpack_draco(std::span<const DracoMesh>, std::uint64_t) {
  return fail("this Weft was built without Draco (libdraco-dev)");
}
#endif

}  // namespace weft::parts
