// What stands about in the simulated worlds: buildings with recessed windows, pillars and roof
// edges, trees, cars, people, hedges, fences, poles, signs, lamps, benches, sheds. Shapes vary with
// a random sequence.
#pragma once

#include "frontend/simulation/mesh.hpp"
#include "frontend/simulation/random.hpp"

namespace groundloop::simulation {

/// A rectangular block: x along the street, y away from it, from the ground up.
struct Block {
  double x0, x1, y0, y1;
  double foot = -1.0;     ///< z of the walls' lower edge, under the ground
  double eaves = 6.0;     ///< z of the walls' upper edge
  double roof = 0.0;      ///< height of the ridge over the eaves; 0 is a flat roof with a parapet
  double overhang = 0.3;  ///< of the roof over the walls
  bool windows = true;
};

/// Walls with recessed windows and pillars, and the roof. The sequence `style` decides spacings.
void add_block(Mesh& mesh, const Place& place, const Block& block, Random style);
/// A lot and what may be built on it: a house of the given width and depth, with its front at
/// y = 0, and porches and wings in the room before and behind it. Metres.
struct Lot {
  double width, depth;
  double before = 0.0, behind = 0.0;
};
/// A house of one to three blocks.
void add_house(Mesh& mesh, const Place& place, const Lot& lot, double height, Random& random);

struct Tree {
  double height = 8.0;
  double foliage = 1.0;  ///< in [0, 1]: how much of the crown is there
  double clear = 0.0;    ///< over the foot; boughs and leaves below it are cut, as beside a way
};

/// A trunk and a crown of scattered leaf clumps. The trunk depends on `shape`, the leaves on
/// `season`.
void add_tree(Mesh& mesh, const Vec3& foot, const Tree& tree, Random shape, Random season);
/// A car of 4 to 5 m (or a van) that heads along the place's x axis, its middle at the place.
void add_car(Mesh& mesh, const Place& place, Random& random);
void add_person(Mesh& mesh, const Place& place, Random& random);
void add_hedge(Mesh& mesh, const Vec3& from, const Vec3& to, double height, double width,
               Random& random);
void add_fence(Mesh& mesh, const Vec3& from, const Vec3& to, double height);
void add_lamp(Mesh& mesh, const Place& place, double height);
void add_sign(Mesh& mesh, const Place& place, Random& random);
void add_bench(Mesh& mesh, const Place& place);
void add_shed(Mesh& mesh, const Place& place, Random& random);

}  // namespace groundloop::simulation
