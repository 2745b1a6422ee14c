// What deformation tells of its organs, as messages: the border between physics in doubles and the
// wire's float32. Headers are the caller's to fill.
#pragma once

#include "deformation/world.h"
#include "modules/geometry/surface_blocks.h"
#include "modules/messages/messages.h"

namespace palpate::deformation {

/// Rest shape, triangles and springs of an organ; of a solid the edges of its tetrahedra, as inner.
SurfaceTopology surface_message(const DeformationWorld& world, std::size_t organ);
/// The same of the mesh that it will go on with.
/// @param next  DeformationWorld::next_mesh()
SurfaceTopology surface_message(const DeformationWorld& world, std::size_t organ,
                                const OrganMesh& next);

/// Positions (float32), volume, pressure and energies of an organ. No allocation once `out` has
/// held the organ.
void write_node_positions(const DeformationWorld& world, std::size_t organ, NodePositions& out);
/// The same with an elastic energy that was found before [J].
void write_node_positions(const DeformationWorld& world, std::size_t organ, double elastic_energy,
                          NodePositions& out);

/// The box of every block of the organ's surface, of the positions that `out` holds.
/// @param blocks  those of surface_message()
void write_block_boxes(const geometry::SurfaceBlocks& blocks, NodePositions& out);

/// Takes what was said of an organ into what it has been so far.
/// @param runs  the session does, or did before
void note_extremes(const NodePositions& said, bool runs, OrganExtremes& of);

/// The tissue's local law for a probe.
ContactModel contact_model_message(const DeformationWorld& world, std::size_t probe,
                                   bool* bounded = nullptr);

}  // namespace palpate::deformation
