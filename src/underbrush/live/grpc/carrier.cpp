// The sensor server over gRPC, a library that the program loads (`carrier.hpp`). It calls nothing
// of the program but `Service`.
#include "underbrush/live/carrier.hpp"

#include <grpc/support/log.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/resource_quota.h>

#include <atomic>

#include "sensor_server.grpc.pb.h"
#include "underbrush/serve/token.hpp"

namespace underbrush::live {
namespace {

using grpc::Status;
using grpc::StatusCode;

Vec3 of(const v1::Vector& v) { return {v.x(), v.y(), v.z()}; }

Pose of(const v1::Pose& p) {
  return {Eigen::Quaterniond(p.qw(), p.qx(), p.qy(), p.qz()), {p.x(), p.y(), p.z()}};
}

void put(const Pose& pose, v1::Pose& out) {
  out.set_x(pose.translation.x());
  out.set_y(pose.translation.y());
  out.set_z(pose.translation.z());
  out.set_qx(pose.rotation.x());
  out.set_qy(pose.rotation.y());
  out.set_qz(pose.rotation.z());
  out.set_qw(pose.rotation.w());
}

Motion of(const v1::Motion& m) {
  Motion out{{}, of(m.velocity_m_per_s()), of(m.turn_rate_rad_per_s())};
  for (const v1::StampedPose& p : m.poses())
    out.poses.push_back({p.time_s(), of(p.world_from_body())});
  return out;
}

FireRequest of(const v1::FireRequest& r) {
  FireRequest out;
  out.firing.start_s = r.start_s();
  out.firing.from_s = r.from_s();
  out.firing.until_s = r.until_s();
  out.firing.vehicle = of(r.vehicle());
  for (const v1::Actor& a : r.actors()) {
    out.firing.actors.push_back({a.name(), of(a.motion()), a.absent()});
  }
  out.columns.assign(r.columns().begin(), r.columns().end());
  out.layout = r.layout();
  out.world = r.world();
  return out;
}

void put(PointCloud& cloud, v1::Cloud& out) {
  out.set_sensor(std::move(cloud.sensor));
  out.set_stamp_s(cloud.world_from_sensor.time_s);
  out.mutable_world_from_sensor()->set_time_s(cloud.world_from_sensor.time_s);
  put(cloud.world_from_sensor.world_from_sensor,
      *out.mutable_world_from_sensor()->mutable_world_from_body());
  out.set_height(cloud.height);
  out.set_width(cloud.width);
  out.set_point_step(cloud.point_step);
  for (const PointField& f : cloud.fields) {
    v1::Field& field = *out.add_fields();
    field.set_name(f.name);
    field.set_offset(f.offset);
    field.set_datatype(f.datatype);
  }
  out.set_data(std::move(cloud.bytes));
}

v1::Part of(Part part) {
  v1::Part out;
  out.set_first_row(part.first_row);
  out.set_rows(part.rows);
  for (Column& c : part.columns) {
    v1::Column& column = *out.add_columns();
    column.set_name(std::move(c.name));
    column.set_type(c.type);
    column.set_width(c.width);
    column.set_data(std::move(c.bytes));
  }
  for (PointCloud& cloud : part.clouds) put(cloud, *out.mutable_cloud());
  return out;
}

/// A call that counts against the limit as long as this exists.
class Counted {
 public:
  explicit Counted(std::atomic<int>& count) : count_(count), number_(++count) {}
  ~Counted() { --count_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  int number() const { return number_; }

 private:
  std::atomic<int>& count_;
  int number_;
};

class Server final : public v1::SensorServer::Service {
 public:
  Server(live::Service& service, const ServerOptions& options)
      : service_(service), options_(options) {}

  Status Describe(grpc::ServerContext* context, const v1::DescribeRequest* request,
                  v1::Description* reply) override {
    return answered(*context, [&] {
      const auto found =
          service_.describe(request->world(), std::min(context->deadline(), latest_deadline()));
      if (found) fill(*found, *reply);
      return found.has_value();
    });
  }

  Status Fire(grpc::ServerContext* context, const v1::FireRequest* request,
              grpc::ServerWriter<v1::Part>* writer) override {
    const Deadline latest = latest_deadline();
    return answered(*context, [&] {
      if (context->deadline() > latest) {
        throw std::invalid_argument("a call needs a deadline of at most a minute");
      }
      return service_.fire(of(*request),
                           {context->deadline(), [&] { return context->IsCancelled(); },
                            [&](Part part) { return writer->Write(of(std::move(part))); }});
    });
  }

 private:
  Deadline latest_deadline() const {
    const std::chrono::duration<double> most(options_.deadline_s + 1);
    return std::chrono::system_clock::now() + std::chrono::duration_cast<Deadline::duration>(most);
  }

  void fill(const Description& d, v1::Description& reply) const {
    reply.set_version(options_.version);
    for (const SensorFacts& s : d.sensors) {
      v1::Sensor& sensor = *reply.add_sensors();
      sensor.set_name(s.name);
      sensor.set_model(s.model);
      sensor.set_rate_hz(s.rate_hz);
      sensor.set_beams_per_revolution(s.beams_per_revolution);
      sensor.set_max_range_m(s.max_range_m);
      put(s.vehicle_from_sensor, *sensor.mutable_vehicle_from_sensor());
    }
    reply.mutable_actors()->Assign(d.actors.begin(), d.actors.end());
    reply.mutable_layouts()->Assign(d.layouts.begin(), d.layouts.end());
    reply.set_max_beams(d.max_beams);
    reply.mutable_worlds()->Assign(d.worlds.begin(), d.worlds.end());
  }

  /// The status of what `answer` does, if the call may be answered.
  template <class Answer>
  Status answered(const grpc::ServerContext& context, const Answer& answer) {
    if (!may_call(context)) return refused();
    const Counted call(calls_);
    if (call.number() > options_.calls) {
      return {StatusCode::RESOURCE_EXHAUSTED, "too many calls at a time"};
    }
    try {
      return answer() ? Status::OK : Status(StatusCode::DEADLINE_EXCEEDED, "not answered in time");
    } catch (const std::invalid_argument& e) {
      return {StatusCode::INVALID_ARGUMENT, e.what()};
    } catch (const std::bad_alloc&) {
      return {StatusCode::RESOURCE_EXHAUSTED, "out of memory"};
    } catch (const std::exception& e) {
      return {StatusCode::INTERNAL, e.what()};
    }
  }

  bool may_call(const grpc::ServerContext& context) const {
    const auto found = context.client_metadata().find("authorization");
    if (found == context.client_metadata().end()) return false;
    return serve::same_token({found->second.data(), found->second.size()},
                             "Bearer " + options_.token);
  }
  static Status refused() {
    return {StatusCode::UNAUTHENTICATED, "the call has no token, or another one"};
  }

  live::Service& service_;
  const ServerOptions& options_;
  std::atomic<int> calls_{0};
};

}  // namespace

extern "C" __attribute__((visibility("default"))) std::string underbrush_live_carrier(
    int version, Service& service, const ServerOptions& options, const ServerStarted& started) {
  constexpr size_t kBuffers = size_t(256) << 20;
  if (version != kCarrierVersion) return "the sensor server is of another build than the program";
  gpr_set_log_function([](gpr_log_func_args*) {});  // What is wrong is returned.
  Server server(service, options);
  grpc::ServerBuilder builder;
  grpc::ResourceQuota quota;
  quota.Resize(kBuffers);
  quota.SetMaxThreads(4 * options.calls);
  builder.SetResourceQuota(quota);
  builder.SetMaxReceiveMessageSize(int(options.request_bytes));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, options.calls);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  int port = -1;
  builder.AddListeningPort(options.address, grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&server);
  const std::unique_ptr<grpc::Server> running = builder.BuildAndStart();
  const bool is_socket = options.address.starts_with("unix:");
  if (!running || (port <= 0 && !is_socket)) return options.address + " cannot be listened to";
  started(is_socket
              ? options.address
              : options.address.substr(0, options.address.rfind(':') + 1) + std::to_string(port));
  running->Wait();
  return "";
}

}  // namespace underbrush::live
