#include "underbrush/serve/http_server.hpp"

#include <charconv>
#include <new>

#include "underbrush/core/check.hpp"
#include "underbrush/serve/bounded_http.inl"
#include "underbrush/serve/json_reply.inl"
#include "underbrush/serve/token.hpp"

namespace underbrush::serve {
namespace {

// What a handler threw, as a reply.
HttpReply answered(const HttpServer::Handler& handler, const HttpRequest& request) {
  try {
    return handler(request);
  } catch (const FormatError& e) {
    return error_reply(422, printable(e.what()));
  } catch (const std::invalid_argument& e) {
    return error_reply(400, printable(e.what()));
  } catch (const std::bad_alloc&) {
    return error_reply(507, "out of memory");
  } catch (const std::exception& e) {
    return error_reply(500, printable(e.what()));
  }
}

std::optional<uint64_t> number_of(std::string_view text) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

constexpr const char* kContentSecurity =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

}  // namespace

std::optional<ByteRange> byte_range_of(const std::string& header) {
  constexpr std::string_view kUnit = "bytes=";
  const std::string_view text = header;
  const size_t dash = text.find('-');
  if (!text.starts_with(kUnit) || dash == std::string_view::npos) return std::nullopt;
  const auto first = number_of(text.substr(kUnit.size(), dash - kUnit.size()));
  if (!first) return std::nullopt;
  if (dash + 1 == text.size()) return ByteRange{*first, std::nullopt};
  const auto last = number_of(text.substr(dash + 1));
  if (!last || *last < *first || *last == UINT64_MAX) return std::nullopt;
  return ByteRange{*first, *last - *first + 1};
}

struct HttpServer::Impl {
  Impl(Handler answer, const HttpLimits& limits) : handler(std::move(answer)), server(limits) {}

  // Whether the request names this machine as its host, in the one header for it.
  bool names_this_host(const httplib::Request& request) const {
    if (request.get_header_value_count("Host") != 1) return false;
    const std::string host = request.get_header_value("Host");
    return host == "127.0.0.1:" + std::to_string(port) ||
           host == "localhost:" + std::to_string(port);
  }

  // Whether a request that changes something comes from the server's own page, or from no page.
  bool may_change(const httplib::Request& request) const {
    const size_t count = request.get_header_value_count("Origin");
    if (count == 0) return true;
    const std::string origin = request.get_header_value("Origin");
    return count == 1 && (origin == "http://127.0.0.1:" + std::to_string(port) ||
                          origin == "http://localhost:" + std::to_string(port));
  }

  HttpReply reply_to(const httplib::Request& request) const {
    if (!names_this_host(request)) return error_reply(403, "no such host here");
    const size_t slash = request.path.find('/', 1);
    const bool known = slash != std::string::npos &&
                       same_token(std::string_view(request.path).substr(1, slash - 1), token);
    if (!known) return error_reply(403, "the address has no token, or an old one");
    const bool post = request.method == "POST";
    if (request.method != "GET" && request.method != "HEAD" && !post) {
      return error_reply(405, "only GET and POST are answered");
    }
    if (post && !may_change(request)) return error_reply(403, "a request of another page");
    if (post && !is_without_body(request)) return error_reply(413, "a request with a body");
    HttpRequest asked{post ? "POST" : "GET", request.path.substr(slash + 1), {}, {}};
    for (const auto& [key, value] : request.params) asked.query[key] = value;
    if (request.has_header("Range")) {
      asked.range = byte_range_of(request.get_header_value("Range"));
      if (!asked.range) return error_reply(416, "one range, bytes=A-B");
    }
    return answered(handler, asked);
  }

  void respond(const httplib::Request& request, httplib::Response& response) const {
    HttpReply reply = reply_to(request);
    response.status = reply.status;
    if (reply.part_of) {
      const auto [first, whole] = *reply.part_of;
      response.status = 206;
      response.set_header("Content-Range", "bytes " + std::to_string(first) + "-" +
                                               std::to_string(first + reply.body.size() - 1) + "/" +
                                               std::to_string(whole));
    }
    response.set_header("Content-Type", reply.type);
    response.body = std::move(reply.body);
  }

  Handler handler;
  std::string token = random_token();
  int port = 0;
  BoundedServer server;
};

HttpServer::HttpServer(int port, Handler handler, const HttpLimits& limits)
    : impl_(std::make_unique<Impl>(std::move(handler), limits)) {
  httplib::Server& s = impl_->server;
  s.set_tcp_nodelay(true);
  s.set_default_headers({{"Content-Security-Policy", kContentSecurity},
                         {"X-Content-Type-Options", "nosniff"},
                         {"Referrer-Policy", "no-referrer"},
                         {"Cross-Origin-Resource-Policy", "same-origin"},
                         {"Cross-Origin-Opener-Policy", "same-origin"},
                         {"Cache-Control", "no-store"}});
  s.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    impl_->respond(request, response);
    return httplib::Server::HandlerResponse::Handled;
  });
  // Without the option SO_REUSEPORT, so that no other program can share the port.
  s.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  impl_->port = port;
  if (port == 0) {
    impl_->port = s.bind_to_any_port("127.0.0.1");
  } else if (!s.bind_to_port("127.0.0.1", port)) {
    impl_->port = -1;
  }
  if (impl_->port <= 0) throw IoError("port " + std::to_string(port) + " of this machine is taken");
  impl_->server.widen_backlog();
}

HttpServer::~HttpServer() = default;

int HttpServer::port() const { return impl_->port; }
const std::string& HttpServer::token() const { return impl_->token; }
std::string HttpServer::address() const {
  return "http://127.0.0.1:" + std::to_string(impl_->port) + "/" + impl_->token + "/";
}
void HttpServer::run() { impl_->server.listen_after_bind(); }
void HttpServer::stop() { impl_->server.stop(); }

}  // namespace underbrush::serve
