// COLLADA, by assimp: the triangles of the scene with the transforms of its nodes.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <utility>
#include <vector>

#include "manyhands/model/io/mesh_file.h"
#include "manyhands/model/io/xml_file.h"

namespace manyhands::io {

namespace {

constexpr unsigned kNotNeeded = aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS;

void append(const aiMesh& part, const aiMatrix4x4& transform, Mesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D v = transform * part.mVertices[i];
    mesh.vertices.push_back({v.x, -v.z, v.y});  // assimp gives y up
  }
  const bool mirrored = transform.Determinant() < 0;
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    std::array<int, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= part.mNumVertices) throw MeshError("a triangle names a vertex that there is not");
      t[k] = first + static_cast<int>(face.mIndices[k]);
    }
    if (mirrored) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }
}

}  // namespace

Mesh read_dae(std::string_view bytes) {
  try {
    const XmlFile check(bytes);
  } catch (const XmlError& error) {
    throw MeshError("line " + std::to_string(error.line()) + ": " + error.what());
  }
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, static_cast<int>(kNotNeeded));
  const aiScene* const scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(),
                                  aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                      aiProcess_ValidateDataStructure,
                                  "dae");
  if (scene == nullptr || scene->mRootNode == nullptr) throw MeshError(importer.GetErrorString());
  Mesh mesh;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> stack{{scene->mRootNode, aiMatrix4x4()}};
  while (!stack.empty()) {
    const auto [node, X_parent] = stack.back();
    stack.pop_back();
    const aiMatrix4x4 X = X_parent * node->mTransformation;
    for (unsigned i = 0; i < node->mNumMeshes; ++i) append(*scene->mMeshes[node->mMeshes[i]], X, mesh);
    for (unsigned i = node->mNumChildren; i > 0; --i) stack.emplace_back(node->mChildren[i - 1], X);
  }
  return mesh;
}

}  // namespace manyhands::io
