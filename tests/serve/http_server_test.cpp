// Ranges of requests. What the server refuses is tested from outside, in
// tests/cli/serve_safety_test.py.
#include "underbrush/serve/http_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <vector>

namespace underbrush::serve {
namespace {

TEST(HttpServer, ParsesOneRange) {
  const auto whole = byte_range_of("bytes=10-19");
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->first, 10u);
  EXPECT_EQ(whole->count, 10u);
  const auto open = byte_range_of("bytes=7-");
  ASSERT_TRUE(open.has_value());
  EXPECT_EQ(open->first, 7u);
  EXPECT_FALSE(open->count.has_value());
  EXPECT_EQ(byte_range_of("bytes=0-0")->count, 1u);
}

TEST(HttpServer, RefusesOtherRanges) {
  for (const char* text :
       {"", "bytes", "bytes=", "bytes=-", "bytes=-5", "bytes=5-4", "bytes=1-2,4-5", "bytes= 1-2",
        "bytes=1-2 ", "bytes=a-b", "lines=1-2", "bytes=0-18446744073709551615",
        "bytes=99999999999999999999-", "bytes=+1-2", "bytes=1--2"}) {
    EXPECT_FALSE(byte_range_of(text).has_value()) << text;
  }
}

TEST(HttpServer, EveryServerHasATokenOfItsOwn) {
  const auto nothing = [](const HttpRequest&) { return HttpReply{}; };
  const HttpServer a(0, nothing), b(0, nothing);
  EXPECT_EQ(a.token().size(), 32u);
  EXPECT_NE(a.token(), b.token());
  EXPECT_NE(a.port(), b.port());
  EXPECT_EQ(a.address(), "http://127.0.0.1:" + std::to_string(a.port()) + "/" + a.token() + "/");
}

// With the backlog of cpp-httplib, the seventh of them waited a second.
TEST(HttpServer, ManyConnectionsAtOnceDoNotWait) {
  const HttpServer server(0, [](const HttpRequest&) { return HttpReply{}; });
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(uint16_t(server.port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::vector<int> sockets;
  int connected = 0;
  for (int k = 0; k < 100; ++k) {
    sockets.push_back(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0));
    ::connect(sockets.back(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
    pollfd ready{sockets.back(), POLLOUT, 0};
    connected += ::poll(&ready, 1, 300);
    if (connected <= k) break;
  }
  EXPECT_EQ(connected, 100);
  for (const int socket : sockets) ::close(socket);
}

}  // namespace
}  // namespace underbrush::serve
