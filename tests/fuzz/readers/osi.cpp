// The readers of OSI's messages and traces, and the FMU, which gets them from other programs.
#include "fmu/model.hpp"
#include "fuzz/readers/reader.hpp"
#include "osi/messages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/osi/lidar_log.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/replay.hpp"
#include "underbrush/osi/trace_contents.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush::fuzz {
namespace {

// What was read can be written, and what was written can be read.
template <class Message>
std::string written(const Message& message) {
  std::string out;
  osi::write(message, out);
  return out;
}

void read_view(std::string_view bytes) {
  osi::type_of_message(bytes);
  osi::read_sensor_view(written(osi::read_sensor_view(std::string(bytes), "message")), "again");
}
void read_data(std::string_view bytes) {
  osi::type_of_message(bytes);
  osi::read_sensor_data(written(osi::read_sensor_data(bytes, "message")), "again");
}
void read_truth(std::string_view bytes) {
  osi::type_of_message(bytes);
  osi::read_ground_truth(written(osi::read_ground_truth(bytes, "message")), "again");
}
void read_configuration(std::string_view bytes) {
  osi::read_configuration(written(osi::read_configuration(bytes, "message")), "again");
}

void read_contents(const Path& path) {
  osi::TraceReader reader(path);
  osi::contents_of(reader);
}
void read_views(const Path& path) {
  osi::TraceReader reader(path);
  osi::log_of_views(reader, {});
}
void read_replay(const Path& path) {
  osi::TraceReader reader(path);
  osi::ReplayOptions options;
  options.strategies = {"alignment", "tracking:gain=0.3", "classification", "grid:half_side_m=10"};
  osi::Replay replay(reader, options);
  for (osi::SensorData data; replay.next(data);) {
  }
}

// A model that was started with the FMU's own chain and a small sensor, and goes back to its start
// each time.
class Fmu {
 public:
  explicit Fmu(const char* input_mode)
      : model_(UNDERBRUSH_FMU_RESOURCES, [](const std::string&) {}) {
    model_.values.integer[fmu::kThreads] = 1;
    model_.values.text[fmu::kProfile] = "spinning.yaml";
    model_.values.text[fmu::kInputMode] = input_mode;
    model_.start();
    start_ = model_.snapshot();
  }
  fmu::Model& started() {
    model_.restore(start_);
    return model_;
  }

 private:
  fmu::Model model_;
  fmu::Snapshot start_;
};

// Steps the FMU with each message of a trace.
void step_fmu(const Path& path, const char* input_mode, fmu::Reference input) {
  static Fmu fmu(input_mode);
  fmu::Model& model = fmu.started();
  osi::TraceReader reader(path);
  for (std::string message; reader.next(message);) {
    model.set_bytes(input, message);
    model.step();
  }
}

// Starts the FMU with the message that the environment simulator offers its rays with.
void start_fmu(std::string_view bytes) {
  fmu::Model model(UNDERBRUSH_FMU_RESOURCES, [](const std::string&) {});
  model.values.integer[fmu::kThreads] = 1;
  model.values.text[fmu::kStrategies] = "alignment";  // Others take seconds to begin.
  model.set_bytes(fmu::kSensorViewInConfig, bytes);
  model.set_bytes(fmu::kGroundTruthInit, bytes);
  model.request();
  model.start();
}

const Reader kReaders[] = {
    {"view", "view.message", read_view},
    {"data", "data.message", read_data},
    {"truth", "truth.message", read_truth},
    {"configuration", "configuration.message", read_configuration},
    {"trace", "views.osi data_sd_.osi", read_contents},
    {"trace-log", "views_sv_.osi", read_views},
    {"trace-lists", "data_sd_.osi views.osi",
     [](const Path& path) { osi::read_trace_lists(path); }},
    {"replay", "views_sv_.osi", read_replay},
    {"chain", "chain.yaml", [](const Path& path) { osi::read_chain(path.string()); }},
    {"fmu-views", "views_sv_.osi",
     [](const Path& path) { step_fmu(path, "reflections", fmu::kSensorViewIn); }},
    {"fmu-truth", "views_sv_.osi views.osi",
     [](const Path& path) { step_fmu(path, "ground_truth", fmu::kSensorViewIn); }},
    {"fmu-data", "data_sd_.osi",
     [](const Path& path) { step_fmu(path, "reflections", fmu::kSensorDataIn); }},
    {"fmu-start", "configuration.message truth.message", start_fmu},
};

}  // namespace

std::span<const Reader> readers() { return kReaders; }

void make_seeds() {
  osi::SensorData data = test::data();
  data.views = {std::make_shared<osi::SensorView>(test::view())};
  osi::SensorViewConfiguration configuration;
  configuration.cycle_s = 0.1;
  configuration.lidar = {*test::view().lidar[0].configuration};
  write_file("view.message", written(test::view()));
  write_file("data.message", written(data));
  write_file("truth.message", written(test::truth()));
  write_file("configuration.message", written(configuration));
  osi::TraceWriter trace("views.osi");
  trace.write(written(test::view()));
  trace.close();
}

}  // namespace underbrush::fuzz
