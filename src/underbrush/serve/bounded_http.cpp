#include "underbrush/serve/bounded_http.inl"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace underbrush::serve {
namespace {

std::chrono::nanoseconds of_seconds(double s) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(s));
}

constexpr double kDrainSeconds = 0.2;
constexpr int kBacklog = 1024;
constexpr size_t kDrainBytes = size_t(4) << 20;

}  // namespace

thread_local bool BoundedQueue::refusing_ = false;

bool BoundedStream::ready(short events, Clock::time_point until) const {
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
    if (left.count() <= 0) return false;
    pollfd wanted{socket_, events, 0};
    const int n = ::poll(&wanted, 1, int(left.count()));
    if (n > 0) return true;
    if (n < 0 && errno != EINTR) return false;
  }
}

bool BoundedStream::wait_for_request() {
  if (!sound_) return false;
  if (at_ == end_ && !ready(POLLIN, Clock::now() + of_seconds(limits_.idle_s))) return false;
  read_until_ = Clock::now() + of_seconds(limits_.request_s);
  bytes_ = 0;
  lines_ = {};
  writing_ = false;
  return at_ < end_ || receive();
}

bool BoundedStream::receive() {
  if (!ready(POLLIN, read_until_)) return false;
  const ssize_t got = ::recv(socket_, ahead_.data(), ahead_.size(), 0);
  at_ = 0;
  end_ = got > 0 ? size_t(got) : 0;
  return got > 0;
}

ssize_t BoundedStream::read(char* to, size_t n) {
  if (bytes_ >= limits_.head_bytes || (at_ == end_ && !receive())) {
    sound_ = false;
    return -1;
  }
  const size_t given = std::min({n, limits_.head_bytes - bytes_, end_ - at_});
  std::copy_n(ahead_.data() + at_, given, to);
  if (!std::all_of(to, to + given, [&](char c) { return lines_.take(c); })) {
    sound_ = false;
    return -1;
  }
  at_ += given;
  bytes_ += given;
  return ssize_t(given);
}

ssize_t BoundedStream::write(const char* from, size_t n) {
  if (!writing_) write_until_ = Clock::now() + of_seconds(limits_.reply_s);
  writing_ = true;
  if (!ready(POLLOUT, write_until_)) {
    sound_ = false;
    return -1;
  }
  const ssize_t sent = ::send(socket_, from, n, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
  if (sent < 0) sound_ = false;
  return sent;
}

void BoundedStream::drain() {
  ::shutdown(socket_, SHUT_WR);
  const Clock::time_point until = Clock::now() + of_seconds(kDrainSeconds);
  char dropped[65536];
  for (size_t bytes = 0; bytes < kDrainBytes && ready(POLLIN, until);) {
    const ssize_t got = ::recv(socket_, dropped, sizeof(dropped), 0);
    if (got <= 0) return;
    bytes += size_t(got);
  }
}

void BoundedStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip = "127.0.0.1";
  port = 0;
}

void BoundedStream::get_local_ip_and_port(std::string& ip, int& port) const {
  ip = "127.0.0.1";
  port = 0;
}

void BoundedQueue::enqueue(std::function<void()> connection) {
  if (open_.load() >= most_) {
    refusing_ = true;
    connection();
    refusing_ = false;
    return;
  }
  ++open_;
  pool_.enqueue([this, work = std::move(connection)] {
    work();
    --open_;
  });
}

void BoundedServer::widen_backlog() { ::listen(svr_sock_, kBacklog); }

bool BoundedServer::process_and_close_socket(socket_t socket) {
  if (BoundedQueue::refusing()) {
    ::close(socket);
    return false;
  }
  BoundedStream stream(socket, limits_);
  bool answered = false, more = true;
  for (size_t left = limits_.requests; more && left > 0 && stream.wait_for_request(); --left) {
    bool closed = false, body = false;
    answered = process_request(stream, left == 1, closed, [&](httplib::Request& request) {
      // Ranges are answered by the handler, one at a time; replies are not compressed, because
      // they stay on this machine.
      request.ranges.clear();
      request.headers.erase("Accept-Encoding");
      body = !is_without_body(request) ||
             (request.method != "GET" && request.method != "HEAD" && request.method != "POST");
    });
    // A body is never read, so that nothing behind it can be a request.
    more = answered && !closed && !body && stream.sound();
  }
  stream.drain();
  ::close(socket);
  return answered;
}

}  // namespace underbrush::serve
