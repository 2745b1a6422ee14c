// The figures of M. Hong, S. Jung, M.-H. Choi, S. W. J. Welch, "Modeling Volume-Preserved Human
// Organs for Surgical Simulation", each as numbers in files: scripts/plots/plot_paper.py draws
// them.
#pragma once

#include <filesystem>

#include "studies/paper/findings.h"
#include "studies/report/progress.h"

namespace palpate::paper {

struct FigureOptions {
  std::filesystem::path scenes;  ///< folder of the scenes that ship
  std::filesystem::path out;     ///< folder to write to; exists
  bool quick = false;            ///< shorter and coarser: seconds instead of minutes
  double budget = 240;           ///< wall time Figure 4 may take before it is cut short [s]
};

/// Figure 1: the springs of stomach and liver by family, virtual nodes on the dominant axis.
/// figure1_{stomach,liver}_{nodes,triangles,springs}.csv
Findings make_spring_figure(const FigureOptions& options, report::Progress& progress);

/// Figure 2: a ball squeezed to half its width by two planes, 800 iterations, without volume
/// constraint, with it, and with one Newton correction. One iteration is one step of 2 ms.
/// figure2_MODEL.csv (one row per iteration) and the shape after the last one.
Findings make_squeeze_figure(const FigureOptions& options, report::Progress& progress);

/// Figure 3: volume over time of stomach and liver under a probe, with and without the constraint.
/// figure3_ORGAN_MODEL.csv
Findings make_volume_figure(const FigureOptions& options, report::Progress& progress);

/// Figure 4: a probe slides through the refined stomach. Force, volume and far-field displacement
/// over time; shapes at first contact and at the end of each rest of the probe. Ends early when the
/// budget of wall time is used up; the finding then says how far it came. Quick: the stomach of 550
/// nodes. figure4.csv, figure4_moments.csv, figure4_MOMENT_nodes.csv
Findings make_slide_figure(const FigureOptions& options, report::Progress& progress);

/// The paper's speed: frames per second of simulating 1/30 s, finding contacts and drawing, all in
/// one thread on one core, in software. frame_rate_VIEW.csv (one row per frame)
/// @throws std::runtime_error if there is no Xvfb to draw into
Findings measure_frame_rate(const FigureOptions& options, report::Progress& progress);

}  // namespace palpate::paper
