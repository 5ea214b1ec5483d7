// cpp-httplib's server with bounds on what a connection may take. Only sources of this module
// include it.
#pragma once
#include <httplib.h>

#include <array>
#include <atomic>
#include <chrono>

#include "underbrush/serve/head_lines.hpp"
#include "underbrush/serve/http_message.hpp"

namespace underbrush::serve {

/// Whether a request has no body, or an empty one.
inline bool is_without_body(const httplib::Request& request) {
  if (request.has_header("Transfer-Encoding")) return false;
  const size_t lengths = request.get_header_value_count("Content-Length");
  return lengths == 0 || (lengths == 1 && request.get_header_value("Content-Length") == "0");
}

/// A connection that allows so many bytes and so much time for each request and its reply.
class BoundedStream : public httplib::Stream {
 public:
  BoundedStream(socket_t socket, const HttpLimits& limits) : socket_(socket), limits_(limits) {}

  /// Waits for the first byte of another request. Returns false if there is none.
  bool wait_for_request();
  /// Whether nothing went wrong: neither bytes nor time ran out.
  bool sound() const { return sound_; }
  /// Reads and drops what the client still sends, for a moment, so that it sees the reply before
  /// the connection is closed.
  void drain();

  bool is_readable() const override { return sound_; }
  bool is_writable() const override { return sound_; }
  ssize_t read(char* to, size_t n) override;
  ssize_t write(const char* from, size_t n) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;
  bool receive();
  bool ready(short events, Clock::time_point until) const;

  socket_t socket_;
  const HttpLimits& limits_;
  Clock::time_point read_until_, write_until_;
  bool writing_ = false, sound_ = true;
  size_t bytes_ = 0;              ///< Read of the request at hand.
  HeadLines lines_;               ///< Checks the head of the request.
  std::array<char, 4096> ahead_;  ///< Bytes [at_, end_) were received and not yet read.
  size_t at_ = 0, end_ = 0;
};

/// Workers, and a short queue in front of them.
class BoundedQueue : public httplib::TaskQueue {
 public:
  BoundedQueue(const HttpLimits& limits)  // NOLINT(google-explicit-constructor)
      : pool_(limits.workers), most_(limits.workers + limits.waiting) {}
  void enqueue(std::function<void()> connection) override;
  void shutdown() override { pool_.shutdown(); }
  /// Whether the connection at hand is one too many.
  static bool refusing() { return refusing_; }

 private:
  httplib::ThreadPool pool_;
  size_t most_;
  std::atomic<size_t> open_{0};
  static thread_local bool refusing_;
};

/// The server: each connection is a `BoundedStream`.
class BoundedServer : public httplib::Server {
 public:
  explicit BoundedServer(const HttpLimits& limits) : limits_(limits) {
    new_task_queue = [this] { return new BoundedQueue(limits_); };
  }
  /// Lets more connections wait to be accepted than the 5 of cpp-httplib, with which a burst of
  /// them loses a second each. Called once the server is bound.
  void widen_backlog();

 private:
  bool process_and_close_socket(socket_t socket) override;

  HttpLimits limits_;
};

}  // namespace underbrush::serve
