#include "frontend/simulation/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <type_traits>

#include <embree3/rtcore.h>
#include <tbb/global_control.h>

#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"
#include "frontend/simulation/random.hpp"

namespace groundloop::simulation {
namespace {

struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

/// A mesh as a scene of its own, and what Embree does not keep of it.
struct Solid {
  SceneHandle scene;
  Vec3 origin = Vec3::Zero();
  std::vector<Material> materials;
  Eigen::AlignedBox2d bounds;  ///< on the ground, in the world (chunks only)
  std::uint64_t key = 0;
  bool moving = false;
};

Solid make_solid(RTCDevice device, const Mesh& mesh) {
  Solid solid;
  solid.origin = mesh.origin;
  solid.materials = mesh.materials;
  solid.scene.reset(rtcNewScene(device));
  rtcSetSceneFlags(solid.scene.get(), RTC_SCENE_FLAG_COMPACT);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), std::max<std::size_t>(1, mesh.vertices.size())));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
      std::max<std::size_t>(1, mesh.triangles.size())));
  check(vertices != nullptr && indices != nullptr, "Embree has memory for a mesh");
  for (const Eigen::Vector3f& v : mesh.vertices) vertices = std::copy_n(v.data(), 3, vertices);
  for (const auto& t : mesh.triangles) indices = std::copy_n(t.data(), 3, indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(solid.scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(solid.scene.get());
  for (const Eigen::Vector3f& v : mesh.vertices) {
    solid.bounds.extend(Vec2(v.head<2>().cast<double>() + mesh.origin.head<2>()));
  }
  return solid;
}

void set_transform(RTCGeometry instance, unsigned step, const Eigen::Matrix3f& rotation,
                   const Eigen::Vector3f& translation) {
  Eigen::Matrix<float, 3, 4> columns;
  columns << rotation, translation;
  rtcSetGeometryTransform(instance, step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
}

}  // namespace

struct RayCaster::Implementation {
  const World& world;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Vec3 centre = Vec3::Zero();
  std::map<ChunkId, Solid> chunks;
  std::vector<Solid> shapes;
  std::vector<const Solid*> instances;       ///< by Embree's geometry id
  std::vector<Eigen::Matrix3f> orientation;  ///< of the instances, at the middle of the scan

  explicit Implementation(const World& w) : world(w) {
    // Embree partitions a build by the threads it sees when the device is made, and the order of
    // triangles in a leaf decides ties: one thread, the same tree whatever the user's --threads.
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    device = rtcNewDevice(nullptr);
    check(device != nullptr, "Embree makes a device");
  }
  ~Implementation() {
    if (scene != nullptr) rtcReleaseScene(scene);
    chunks.clear();
    shapes.clear();
    rtcReleaseDevice(device);
  }

  void load_chunks(const Vec2& at, double reach);
  void attach(const Solid& solid, const Pose& start, const Pose& end);
};

void RayCaster::Implementation::load_chunks(const Vec2& at, double reach) {
  const double size = world.chunk_size(), far = reach + world.overhang();
  const auto first = [&](double x) { return static_cast<int>(std::floor((x - far) / size + 0.5)); };
  const auto last = [&](double x) { return static_cast<int>(std::floor((x + far) / size + 0.5)); };
  std::vector<ChunkId> missing;
  const ChunkId low{first(at.x()), first(at.y())}, high{last(at.x()), last(at.y())};
  for (int i = low.i; i <= high.i; ++i) {
    for (int j = low.j; j <= high.j; ++j) {
      if (!chunks.contains({i, j})) missing.push_back({i, j});
    }
  }
  if (missing.empty()) return;
  std::vector<Mesh> meshes(missing.size());
  parallel_for(missing.size(), 1, [&](std::size_t k) {
    const Vec2 middle = size * Vec2(missing[k].i, missing[k].j);
    meshes[k].origin = Vec3(middle.x(), middle.y(), world.ground(middle));
    world.build(missing[k], meshes[k]);
  });
  for (std::size_t k = 0; k < missing.size(); ++k) {
    Solid solid = make_solid(device, meshes[k]);
    solid.key = key_of(1, missing[k].i, missing[k].j);
    chunks.emplace(missing[k], std::move(solid));
  }
  std::erase_if(chunks, [&](const auto& entry) {
    const ChunkId& id = entry.first;
    return id.i < low.i - 1 || id.j < low.j - 1 || id.i > high.i + 1 || id.j > high.j + 1;
  });
}

void RayCaster::Implementation::attach(const Solid& solid, const Pose& start, const Pose& end) {
  RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, solid.scene.get());
  const unsigned steps = solid.moving ? 2 : 1;
  rtcSetGeometryTimeStepCount(instance, steps);
  for (unsigned step = 0; step < steps; ++step) {
    const PoseF T(step == 0 ? start : end);
    set_transform(instance, step, T.rotation, T.translation);
  }
  rtcCommitGeometry(instance);
  rtcAttachGeometryByID(scene, instance, static_cast<unsigned>(instances.size()));
  rtcReleaseGeometry(instance);
  instances.push_back(&solid);
  orientation.push_back(PoseF(interpolate(start, end, 0.5)).rotation);
}

RayCaster::RayCaster(const World& world)
    : implementation_(std::make_unique<Implementation>(world)) {}
RayCaster::~RayCaster() = default;

std::size_t RayCaster::add_shape(const Mesh& mesh) {
  auto& shapes = implementation_->shapes;
  shapes.push_back(make_solid(implementation_->device, mesh));
  shapes.back().moving = true;
  shapes.back().key = key_of(2, shapes.size());
  return shapes.size() - 1;
}

void RayCaster::prepare(const Vec3& centre, double reach, std::span<const MovingBody> bodies) {
  Implementation& self = *implementation_;
  self.load_chunks(centre.head<2>(), reach);
  if (self.scene != nullptr) rtcReleaseScene(self.scene);
  self.scene = rtcNewScene(self.device);
  self.instances.clear();
  self.orientation.clear();
  self.centre = centre;
  for (const auto& [id, chunk] : self.chunks) {
    const Vec2 at = centre.head<2>();
    if (chunk.bounds.exteriorDistance(at) > reach) continue;
    const Pose T(Eigen::Quaterniond::Identity(), chunk.origin - centre);
    self.attach(chunk, T, T);
  }
  for (const MovingBody& body : bodies) {
    Pose start = body.start, end = body.end;
    start.translation -= centre;
    end.translation -= centre;
    if (start.translation.norm() > reach) continue;
    self.attach(self.shapes[body.shape], start, end);
  }
  rtcCommitScene(self.scene);
}

Hit RayCaster::cast(const Ray& ray, float max_range) const {
  const Implementation& self = *implementation_;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x();
  query.ray.org_y = ray.origin.y();
  query.ray.org_z = ray.origin.z();
  query.ray.dir_x = ray.direction.x();
  query.ray.dir_y = ray.direction.y();
  query.ray.dir_z = ray.direction.z();
  query.ray.time = ray.time;
  query.ray.tfar = max_range;
  query.ray.mask = 0xffffffffU;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(self.scene, &context, &query);
  Hit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  const unsigned instance = query.hit.instID[0];
  const Solid& solid = *self.instances[instance];
  hit.range = query.ray.tfar;
  hit.material = solid.materials[query.hit.primID];
  hit.moving = solid.moving;
  hit.surface = key_of(solid.key, query.hit.primID);
  const Eigen::Vector3f normal(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  hit.normal = self.orientation[instance] * normal.normalized();
  return hit;
}

}  // namespace groundloop::simulation
