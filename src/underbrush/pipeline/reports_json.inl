// The reports of verbs as JSON, whose keys other programs rely on; those of fit and score are in
// fit_json.inl and score_json.inl. This file is for sources that use JSON.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "underbrush/actors/learn_actors.hpp"
#include "underbrush/osi/trace_contents.hpp"
#include "underbrush/perception/list_scores.hpp"
#include "underbrush/perception/mover_score.hpp"
#include "underbrush/pipeline/annotate_site.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/pipeline/import_log.hpp"
#include "underbrush/pipeline/log_contents.hpp"
#include "underbrush/pipeline/mark_movers.hpp"
#include "underbrush/pipeline/mesh_set.hpp"
#include "underbrush/pipeline/perceive_log.hpp"
#include "underbrush/pipeline/segment_log.hpp"
#include "underbrush/primitives/extract.hpp"
#include "underbrush/regions/site_folder.hpp"

namespace underbrush::pipeline {

/// Returns what became of the log's records.
nlohmann::ordered_json json_of(const ImportReport& report);
/// Returns the number of marked returns, and with a truth how many objects they are on.
nlohmann::ordered_json json_of(const MoverMarks& marks, const perception::MoverScore* score,
                               const SkippedRows& skipped);
/// Returns what was learnt of each track.
nlohmann::ordered_json json_of(const actors::LearntActors& learnt);
/// Returns the counts and scores of a segmentation.
nlohmann::ordered_json json_of(const Segmentation& segmentation, const SegmentOptions& options,
                               const SkippedRows& skipped);

/// Returns the objects by class, and the numbers of parts and of triangles of the ground.
nlohmann::ordered_json json_of(const regions::GeneratedSite& site);
/// Returns the objects by class, and what was left out.
nlohmann::ordered_json json_of(const primitives::MeasuredObjects& measured);
/// Returns the same, for a generated site with what was not drawn as wanted and the statistics.
nlohmann::ordered_json json_of(const AnnotatedSite& site);
/// Returns the primitives by class, and what was left out.
nlohmann::ordered_json json_of(const primitives::ExtractResult& result);
/// Returns the primitives and triangles by class, and by how much plants were scaled.
nlohmann::ordered_json json_of(const MeshSet& set, const MeshesOptions& options);
/// Returns counts of what was placed and left out, warnings and the time.
nlohmann::ordered_json json_of(const ComposedScene& scene, const ComposeOptions& options);

/// Returns the scores of lists of objects.
nlohmann::ordered_json json_of(const perception::ListScore& score);
/// Returns the rows of [rosenberger20] Table 1.
nlohmann::ordered_json json_of(std::span<const perception::ComparedObject> objects);
/// Returns counts, the scores against the truth if there is one, and the area of each kind of cells
/// if there is a grid.
nlohmann::ordered_json json_of(const Perceived& perceived);
/// Returns what a trace of messages of that type holds.
nlohmann::ordered_json json_of(const osi::TraceContents& contents, osi::MessageType type);

}  // namespace underbrush::pipeline
