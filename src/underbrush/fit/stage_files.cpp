#include "underbrush/fit/stage_files.hpp"

#include <nlohmann/json.hpp>

#include "underbrush/compact/cursor.hpp"
#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/fit/training_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::fit {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using io::JsonValue;
using likelihood::ListedBeam;
using likelihood::PassSums;
using likelihood::Refinement;

constexpr const char *kModel = "model", *kRefinement = "refinement.json", *kStart = "start",
                     *kReport = "start.json", *kHeldOut = "held_out.bin", *kOpen = "open.bin";
constexpr const char* kFormat = "underbrush-fit-stage";
constexpr std::string_view kSumsHead = "underbrush-sums 1\n";

/// The counts of a report that are known before the refinement.
constexpr std::pair<const char*, size_t FitReport::*> kCounts[] = {
    {"beams", &FitReport::beams},
    {"hits", &FitReport::hits},
    {"misses", &FitReport::misses},
    {"ground_points", &FitReport::ground_points},
    {"other_points", &FitReport::other_points},
    {"mover_points", &FitReport::mover_points},
    {"near_points", &FitReport::near_points},
    {"far_points", &FitReport::far_points},
    {"thinned_points", &FitReport::thinned_points},
    {"unclustered_points", &FitReport::unclustered_points},
    {"free_space_ellipsoids", &FitReport::free_space_ellipsoids},
    {"tiles", &FitReport::tiles}};

Json json_of(const FitReport& r) {
  Json j;
  for (const auto& [name, count] : kCounts) j["counts"][name] = r.*count;
  j["range_noise_m"] = r.range_noise_m;
  j["warnings"] = r.warnings;
  const calibrate::LeafAngleReport& leaves = r.leaf_angles;
  j["leaf_angles"] = {{"cells", leaves.cells},
                      {"hits", leaves.hits},
                      {"chi", leaves.chi},
                      {"deviation", leaves.deviation},
                      {"used", leaves.used}};
  return j;
}

FitReport report_of(const JsonValue& j) {
  FitReport r;
  const JsonValue counts = j.at("counts"), leaves = j.at("leaf_angles");
  for (const auto& [name, count] : kCounts) r.*count = counts.at(name).count();
  r.range_noise_m = j.at("range_noise_m").number();
  if (!(r.range_noise_m >= 0)) j.at("range_noise_m").fail("it must not be negative");
  for (const JsonValue& warning : j.at("warnings").values()) r.warnings.push_back(warning.text());
  r.leaf_angles = {leaves.at("cells").count(), leaves.at("hits").count(), leaves.at("chi").number(),
                   leaves.at("deviation").number(), leaves.at("used").boolean()};
  return r;
}

Json json_of(const Refinement& r) {
  Json j{{"format", kFormat},
         {"version", 1},
         {"held_out_nll", r.held_out_nll},
         {"unexplained", {{"hit", r.soft.hit}, {"miss", r.soft.miss}}},
         {"step", r.step},
         {"round", r.round},
         {"stride", r.stride},
         {"training_beams", r.report.training_beams},
         {"held_out_beams", r.report.held_out_beams},
         {"held_out_hits", r.report.held_out_hits},
         {"stray_hits", r.report.stray_hits},
         {"steps", Json::array()}};
  for (const likelihood::LikelihoodStep& s : r.report.steps) {
    Json step{{"name", s.name},
              {"elements", s.elements},
              {"held_out_nll", s.held_out_nll},
              {"accepted", s.accepted}};
    if (s.training_nll) step["training_nll"] = *s.training_nll;
    j["steps"].push_back(std::move(step));
  }
  return j;
}

likelihood::LikelihoodStep step_of(const JsonValue& j) {
  likelihood::LikelihoodStep step{j.at("name").text(),
                                  j.at("elements").count(),
                                  {},
                                  j.at("held_out_nll").number(),
                                  j.at("accepted").boolean()};
  if (const auto nll = j.find("training_nll")) step.training_nll = nll->number();
  return step;
}

/// Writes a refinement into a folder that is being made.
void put_refinement(const fs::path& folder, const Refinement& r) {
  elements::write_model(folder / kModel, r.best->model);
  write_file(folder / kRefinement, io::text_of_json(json_of(r), 1) + "\n");
}

template <class Row>
void put_rows(const fs::path& file, const std::vector<Row>& rows) {
  write_file(file, {reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(Row)});
}

template <class Row>
std::vector<Row> rows_of(const fs::path& file) {
  const InputFile bytes(file);
  if (bytes.size() % sizeof(Row) != 0) throw FormatError(bytes.name(), "", "ends too early");
  std::vector<Row> rows(bytes.size() / sizeof(Row));
  bytes.read(0, rows.data(), bytes.size());
  return rows;
}

bool is_usable(const ListedBeam& b) {
  const Vec3f origin(b.origin), direction(b.direction);
  constexpr float kLoose = 1e-3f;
  return is_within(origin, float(kMaxCoordinate)) && std::abs(direction.norm() - 1) < kLoose &&
         b.range_m >= 0 && b.reach_m >= 0;
}

/// Whether a covariance (m²) is that of an ellipsoid that a log can hold.
bool is_usable(const Eigen::Matrix3f& covariance) {
  return is_within(covariance, float(kMaxCoordinate));
}

template <class Row>
std::vector<Row> usable_rows_of(const fs::path& file) {
  std::vector<Row> rows = rows_of<Row>(file);
  for (size_t k = 0; k < rows.size(); ++k) {
    if (!is_usable(rows[k])) {
      throw FormatError(file.string(), "row " + std::to_string(k), "its numbers make no sense");
    }
  }
  return rows;
}

/// Appends the rows of elements that have sums, each after the element's number.
template <class Rows>
void put_rows(std::string& out, const Rows& rows, size_t fields) {
  const auto is_zero = [&](const auto& row) {
    return std::all_of(row.begin(), row.begin() + ptrdiff_t(fields),
                       [](const auto& sum) { return sum == decltype(sum){}; });
  };
  const size_t at = out.size();
  compact::put(out, uint64_t(rows.size()));
  compact::put(out, uint64_t(0));
  uint64_t count = 0;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (is_zero(rows[i])) continue;
    ++count;
    compact::put(out, uint32_t(i));
    out.append(reinterpret_cast<const char*>(rows[i].data()), fields * sizeof(int64_t));
  }
  std::memcpy(out.data() + at + sizeof(uint64_t), &count, sizeof count);
}

/// Adds such rows by `add(row of the sums, 64 bits of a field, number of the field)`.
template <class Rows, class Add>
void add_rows(compact::Cursor& in, Rows& rows, size_t fields, Add add) {
  if (in.get<uint64_t>() != rows.size()) in.fail("it is of another number of elements");
  const uint64_t count = in.get<uint64_t>();
  if (count > rows.size()) in.fail("more rows than elements");
  for (uint64_t k = 0; k < count; ++k) {
    const uint32_t element = in.get<uint32_t>();
    if (element >= rows.size()) in.fail("no such element");
    for (size_t f = 0; f < fields; ++f) add(rows[element][f], in.get<int64_t>());
  }
}

}  // namespace

void write_start(const fs::path& folder, const FitStart& start, const Refinement& refinement,
                 const FitOptions& options) {
  io::write_atomically(
      folder,
      [&](const fs::path& to) {
        make_temporary_folders(to);
        put_refinement(to, refinement);
        const FitRecord& record = start.fitted.record;
        elements::write_model(to / kStart, start.fitted.model, [&](const fs::path& model) {
          if (!record.tiles.empty()) write_training(model, {options, false, {}, record});
        });
        Json report = json_of(start.fitted.report);
        report["training_beams"] = start.training_beams;
        write_file(to / kReport, io::text_of_json(report, 1) + "\n");
        put_rows(to / kHeldOut, start.held_out);
        put_rows(to / kOpen, start.fitted.open);
      },
      io::OutputKind::kFolder);
}

FitStart read_start(const fs::path& folder) {
  FitStart out;
  out.fitted.model = elements::read_model(folder / kStart);
  if (has_training(folder / kStart)) out.fitted.record = read_training(folder / kStart).record;
  const io::JsonFile report(folder / kReport);
  out.fitted.report = report_of(report.root());
  out.training_beams = report.root().at("training_beams").count();
  out.held_out = usable_rows_of<ListedBeam>(folder / kHeldOut);
  out.fitted.open = usable_rows_of<Eigen::Matrix3f>(folder / kOpen);
  if (!out.fitted.open.empty() && out.fitted.open.size() != out.fitted.model.ellipsoids.size()) {
    throw FormatError((folder / kOpen).string(), "", "it is of another number of ellipsoids");
  }
  return out;
}

void write_refinement(const fs::path& folder, const Refinement& refinement) {
  io::write_atomically(
      folder,
      [&](const fs::path& to) {
        make_temporary_folders(to);
        put_refinement(to, refinement);
      },
      io::OutputKind::kFolder);
}

Refinement read_refinement(const fs::path& folder) {
  Refinement r;
  const io::JsonFile file(folder / kRefinement);
  const JsonValue j = file.manifest(kFormat, 1, "the refinement of a fit");
  r.held_out_nll = j.at("held_out_nll").number();
  r.soft = {j.at("unexplained").at("hit").number(), j.at("unexplained").at("miss").number()};
  r.step = j.at("step").count();
  r.round = int(j.at("round").count(INT32_MAX));
  r.stride = j.at("stride").number();
  r.report.training_beams = j.at("training_beams").count();
  r.report.held_out_beams = j.at("held_out_beams").count();
  r.report.held_out_hits = j.at("held_out_hits").count();
  r.report.stray_hits = j.at("stray_hits").number();
  for (const JsonValue& step : j.at("steps").values()) r.report.steps.push_back(step_of(step));
  if (r.step >= r.report.steps.size()) j.at("step").fail("no such step");
  r.best = std::make_shared<likelihood::TracedModel>(elements::read_model(folder / kModel));
  return r;
}

void write_sums(const fs::path& file, const PassSums& sums) {
  std::string out(kSumsHead);
  compact::put(out, sums.beams);
  compact::put(out, sums.totals.loss.bits());
  compact::put(out, sums.totals.stray_hits.bits());
  for (const likelihood::MeshNoise& mesh : sums.totals.noise) {
    for (const likelihood::FixedSum& sum : mesh) compact::put(out, sum.bits());
  }
  put_rows(out, sums.elements.triangle_rows(), 4);
  put_rows(out, sums.elements.ellipsoid_rows(), likelihood::kSumFields);
  io::write_atomically(file, out);
}

void add_sums(const fs::path& file, PassSums& sums) {
  const std::string name = file.string(), bytes = read_file(file), nowhere;
  compact::Cursor in(bytes, name, nowhere);
  if (in.take(kSumsHead.size()) != kSumsHead) in.fail("not the sums of a pass");
  const auto add = [](likelihood::FixedSum& to, int64_t bits) {
    to.add(likelihood::FixedSum(bits));
  };
  sums.beams += in.get<uint64_t>();
  add(sums.totals.loss, in.get<int64_t>());
  add(sums.totals.stray_hits, in.get<int64_t>());
  for (likelihood::MeshNoise& mesh : sums.totals.noise) {
    for (likelihood::FixedSum& sum : mesh) add(sum, in.get<int64_t>());
  }
  add_rows(in, sums.elements.triangle_rows(), 4, add);
  add_rows(in, sums.elements.ellipsoid_rows(), likelihood::kSumFields,
           [](int64_t& to, int64_t sum) { to += sum; });
}

}  // namespace underbrush::fit
