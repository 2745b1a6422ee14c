#include "collision/mesh_solid.h"

#include <catch2/catch.hpp>

#include "tests/collision/finder_scene.h"

namespace palpate::collision {

TEST_CASE("mesh solid: a meshed box answers like the box") {
  // Oracle: the analytic box solid.
  RandomShapes random(61);
  const Vec3 size(1, 0.6, 0.4);
  const SharpMesh mesh(geometry::make_box(size, 3));
  const auto meshed = make_mesh_solid(mesh), box = make_box_solid(size);
  int entries = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 x = random.point(0.8), end = random.point(0.8);
    const auto one = meshed->nearest(x, 2), other = box->nearest(x, 2);
    REQUIRE(one);
    CHECK(one->distance == Approx(other->distance).margin(1e-12));
    CHECK((one->point + one->distance * one->outward - x).norm() < 1e-12);
    const auto entered = meshed->entry(x, end, 0), wanted = box->entry(x, end, 0);
    // Ways that touch an edge within the tolerance of the continuous test may be called either way.
    if (wanted) {
      REQUIRE(entered);
      CHECK(entered->time == Approx(wanted->time).margin(1e-6));
      ++entries;
    }
    CHECK(meshed->shadows(x, end.normalized()) == box->shadows(x, end.normalized()));
  }
  CHECK(entries > 50);
  CHECK_FALSE(meshed->nearest({2, 0, 0}, 0.5));
}

TEST_CASE("mesh solid: a cone's signed distance, and where a point enters it") {
  // Oracle: analytic, of the smooth cone; the flats are inside it by radius × (1 − cos(π/32)).
  const double radius = 0.3, length = 1, inside_by = radius * (1 - std::cos(M_PI / 32));
  const SharpMesh mesh(geometry::make_cone(radius, length, 32));
  const auto solid = make_mesh_solid(mesh);
  const auto smooth = [&](const Vec3& x) {
    const Vec3 p(std::hypot(x[0], x[1]), x[2], 0), rim(radius, length, 0), top(0, length, 0);
    const auto to = [&](const Vec3& a, const Vec3& b) {
      return (p - geometry::closest_of_segments(p, p, a, b).on_second).norm();
    };
    const double distance = std::min(to(Vec3::Zero(), rim), to(rim, top));
    return p[1] < length && p[0] < radius * p[1] / length ? -distance : distance;
  };
  RandomShapes random(63);
  int entries = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 start = Vec3(0, 0, 0.5) + random.point(0.8),
               end = Vec3(0, 0, 0.5) + random.point(0.5);
    const auto near = solid->nearest(start, 2);
    REQUIRE(near);
    CHECK(near->distance >= smooth(start) - 1e-12);
    CHECK(near->distance <= smooth(start) + inside_by + 1e-12);
    if (near->distance < 0) continue;
    const auto entered = solid->entry(start, end, 0);
    // Nothing is in it on a way without an entry; at an entry the way is on its surface.
    if (entered) {
      ++entries;
      CHECK(std::abs(solid->nearest(entered->point, 1)->distance) < 1e-6);
      continue;
    }
    for (int i = 1; i <= 20; ++i) {
      CHECK(solid->nearest(start + i / 20.0 * (end - start), 2)->distance > -1e-7);
    }
  }
  CHECK(entries > 100);
}

TEST_CASE("mesh solid: the sign is right next to sharp edges and corners") {
  // Oracle: analytic; the signed distance of a tetrahedron as the largest of its planes' distances,
  // exact inside and of the right sign everywhere.
  const auto tetrahedron = geometry::make_tetrahedron(1);
  const SharpMesh mesh(tetrahedron);
  const auto solid = make_mesh_solid(mesh);
  RandomShapes random(62);
  for (int trial = 0; trial < 2000; ++trial) {
    // Near corners and edges, where the nearest feature is not a face.
    const auto& nodes = tetrahedron.nodes;
    const double along = trial % 2 == 0 ? 0 : random.number(0, 1);
    const Vec3 x =
        nodes[trial % 4] + along * (nodes[(trial + 1) % 4] - nodes[trial % 4]) + random.point(0.1);
    double planes = -1e9;
    for (const auto& t : tetrahedron.triangles) {
      const geometry::TriangleCorners c{nodes[t[0]], nodes[t[1]], nodes[t[2]]};
      planes = std::max(planes, geometry::unit_normal(c).dot(x - c[0]));
    }
    const auto near = solid->nearest(x, 1);
    REQUIRE(near);
    CHECK((near->distance < 0) == (planes < 0));
    if (planes < 0) CHECK(near->distance == Approx(planes).margin(1e-12));
  }
}

TEST_CASE("sharp mesh: a box has twelve edges whatever its triangles") {
  // Oracle: analytic.
  for (const int divisions : {1, 3}) {
    const SharpMesh mesh(geometry::make_box({2, 2, 2}, divisions));
    CHECK(mesh.edges().size() == 12u * divisions);
    for (const SharpEdge& edge : mesh.edges()) {
      CHECK(std::abs(edge.face_normals[0].dot(edge.face_normals[1])) < 1e-15);
      for (int k = 0; k < 2; ++k) {
        CHECK(edge.into_face[k].norm() == Approx(1));
        CHECK(std::abs(edge.into_face[k].dot(edge.face_normals[k])) < 1e-15);
        // Into one face is against the other's normal on a box.
        CHECK(edge.into_face[k].dot(edge.face_normals[1 - k]) == Approx(-1));
      }
    }
    CHECK(mesh.bounds().lower == Vec3(-1, -1, -1));
    CHECK(mesh.bounds().upper == Vec3(1, 1, 1));
  }
}

TEST_CASE("sharp mesh: features near a box are those in it") {
  // Oracle: analytic.
  const SharpMesh mesh(geometry::make_box({2, 2, 2}));
  std::vector<std::uint32_t> vertices, edges;
  Bounds corner{Vec3(1, 1, 1), Vec3(1, 1, 1)};
  corner.inflate(0.1);
  mesh.append_vertices(corner, vertices);
  REQUIRE(vertices.size() == 1);
  CHECK(mesh.vertices()[vertices[0]] == Vec3(1, 1, 1));
  mesh.append_edges(corner, corner, {}, edges);
  CHECK(edges.size() == 3);
  vertices.clear();
  edges.clear();
  const Bounds on_face{Vec3(-0.1, -0.1, 0.9), Vec3(0.1, 0.1, 1.1)};
  mesh.append_vertices(on_face, vertices);
  mesh.append_edges(on_face, on_face, {}, edges);
  CHECK(vertices.empty());
  CHECK(edges.empty());
}

TEST_CASE("sharp mesh: the vertices nearest to a triangle are those that brute force finds") {
  // Oracle: brute force over all vertices.
  RandomShapes random(23);
  const SharpMesh mesh(random.deformed_ball(1, 3));
  for (int trial = 0; trial < 60; ++trial) {
    const geometry::TriangleCorners to = random.triangle(1.5);
    const auto count = static_cast<std::size_t>(random.number(1, 40));
    const double within = random.number(0.05, 1);
    std::vector<std::uint32_t> found{7};  // what is there stays
    mesh.append_nearest_vertices(to, within, count, found);
    REQUIRE(found.front() == 7);
    found.erase(found.begin());
    std::vector<double> distances, brute;
    const auto distance = [&](const Vec3& x) {
      return (x - geometry::closest_on_triangle(x, to).point).norm();
    };
    for (const std::uint32_t vertex : found) distances.push_back(distance(mesh.vertices()[vertex]));
    for (const Vec3& x : mesh.vertices()) {
      if (distance(x) <= within) brute.push_back(distance(x));
    }
    std::ranges::sort(distances);
    std::ranges::sort(brute);
    brute.resize(std::min(brute.size(), count));
    CHECK(distances == brute);
  }
}

TEST_CASE("sharp mesh: triangles along a segment are all that come near it, and few others") {
  // Oracle: brute force over all triangles.
  RandomShapes random(29);
  const SharpMesh mesh(random.deformed_ball(1, 4));
  std::size_t near = 0, listed = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Vec3 a = random.triangle(2)[0], b = trial % 5 == 0 ? a : random.triangle(2)[0];
    const double within = random.number(0, 0.1);
    std::vector<std::uint32_t> found;
    mesh.append_triangles_along(a, b, within, found);
    std::ranges::sort(found);
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
      const auto [i, j, k] = mesh.triangles()[t];
      const geometry::TriangleCorners corners{mesh.vertices()[i], mesh.vertices()[j],
                                              mesh.vertices()[k]};
      const bool is_near =
          geometry::closest_of_segment_and_triangle(a, b, corners).distance <= within;
      near += is_near;
      if (is_near) CHECK(std::ranges::binary_search(found, t));
    }
    listed += found.size();
  }
  CHECK(near > 100);
  CHECK(listed < 4 * near);
}

TEST_CASE("sharp mesh: degenerate triangles take no part") {
  // Oracle: invariant; the same answers without them.
  auto surface = geometry::make_box({2, 2, 2});
  surface.triangles.push_back({0, 0, 1});
  const SharpMesh mesh(surface);
  const auto solid = make_mesh_solid(mesh);
  CHECK(mesh.edges().size() == 12);
  const auto near = solid->nearest({0.1, 0.2, 1.5}, 1);
  REQUIRE(near);
  CHECK(near->distance == Approx(0.5));
  CHECK(near->outward.allFinite());
}

TEST_CASE("contact finder: a mesh probe agrees with the box it is made like") {
  // Oracle: the same shape by another path.
  const Vec3 size(0.02, 0.03, 0.01);
  RandomShapes random(12);
  for (int trial = 0; trial < 20; ++trial) {
    const auto ball = random.deformed_ball(0.05, 3);
    const Quat rotation = random.rotation();
    const Vec3 position = random.direction() * random.number(0.058, 0.066);
    FinderScene as_box(ball, scene::BoxShape{size});
    FinderScene as_mesh({ball}, {scene::form_of(scene::MeshShape{}, geometry::make_box(size))});
    // Both come from outside: of what begins inside, lines within are held, which differ.
    as_box.find(resting(2 * position, rotation), 0.002);
    as_mesh.find(resting(2 * position, rotation), 0.002);
    const ProbeMotion in{at(2 * position, rotation), at(position, rotation)};
    const ContactSet one = as_box.find(in, 0.002), other = as_mesh.find(in, 0.002);
    REQUIRE(one.contacts.size() == other.contacts.size());
    for (std::size_t i = 0; i < one.contacts.size(); ++i) {
      CHECK(one.contacts[i].triangle == other.contacts[i].triangle);
      CHECK(one.contacts[i].gap == Approx(other.contacts[i].gap).margin(1e-12));
    }
  }
}

}  // namespace palpate::collision
