#include "underbrush/osi/list_file.hpp"

#include <stdexcept>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/trace.hpp"
#include "underbrush/osi/write.hpp"
#include "underbrush/perception/object_list_file.hpp"

namespace underbrush::osi {
namespace {

// The true objects of a view or of a ground truth. Simulators may send the number of the host once
// only, so `host` keeps it.
perception::ObjectList true_list(TraceReader& reader, std::string message,
                                 std::optional<uint64_t>& host) {
  GroundTruth truth;
  if (reader.type() == MessageType::kGroundTruth) {
    truth = read_ground_truth(message, reader.place());
    if (truth.host_vehicle_id) host = truth.host_vehicle_id;
  } else {
    SensorView view = read_sensor_view(std::move(message), reader.place());
    if (!view.truth) throw FormatError(reader.place(), "", "the view has no ground truth");
    truth = std::move(*view.truth);
    if (view.timestamp) truth.timestamp = view.timestamp;
    if (truth.host_vehicle_id) host = truth.host_vehicle_id;
    if (view.host_vehicle_id) host = view.host_vehicle_id;
  }
  if (!truth.timestamp) throw FormatError(reader.place(), "timestamp", "missing");
  perception::TruthFrame frame;
  truth_of(truth, host, reader.place(), frame);
  const MovingObject* vehicle = host ? truth.find(*host) : nullptr;
  return perception::list_of_truth(frame, vehicle ? world_from_vehicle(*vehicle) : Pose{});
}

}  // namespace

void check_list_name(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension.empty() || extension == ".csv" || extension == ".json" || extension == ".osi") {
    return;
  }
  throw std::invalid_argument(
      path.string() + ": lists of objects are written as .csv, .json or .osi, not as " + extension);
}

void write_lists(const std::filesystem::path& path, std::span<const perception::ObjectList> lists,
                 const std::string& provenance) {
  check_list_name(path);
  if (!is_trace_file(path)) return perception::write_object_lists(path, lists, provenance);
  TraceWriter writer(path, provenance);
  for (const SensorData& data : data_of(lists)) {
    std::string message;
    write(data, message);
    writer.write(message);
  }
  writer.close();
}

std::vector<perception::ObjectList> read_trace_lists(const std::filesystem::path& path) {
  TraceReader reader(path);
  std::vector<perception::ObjectList> lists;
  std::optional<uint64_t> host;
  for (std::string message; reader.next(message);) {
    if (reader.type() == MessageType::kSensorData) {
      lists.push_back(list_of(read_sensor_data(message, reader.place())));
    } else {
      lists.push_back(true_list(reader, std::move(message), host));
    }
    if (lists.size() > 1 && lists.back().time_s <= lists[lists.size() - 2].time_s) {
      throw FormatError(reader.place(), "timestamp", "times must ascend");
    }
  }
  return lists;
}

std::vector<perception::ObjectList> read_lists(const std::filesystem::path& path) {
  return is_trace_file(path) ? read_trace_lists(path) : perception::read_object_lists(path);
}

bool is_list_file(const std::filesystem::path& path) {
  return is_trace_file(path) || perception::is_object_list_file(path);
}

perception::LogTruth truth_of_log(const std::filesystem::path& path, const LogInfo& log,
                                  const perception::LogTruthOptions& options) {
  if (is_trace_file(path)) return perception::LogTruth(read_trace_lists(path));
  return {path, log, options};
}

}  // namespace underbrush::osi
