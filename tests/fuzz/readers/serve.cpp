// What the server reads: requests, journals of labels, and octrees.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>

#include "fuzz/readers/reader.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/serve/api.hpp"
#include "underbrush/serve/label_document.hpp"
#include "underbrush/serve/labels_of_file.hpp"
#include "underbrush/serve/selection.hpp"

namespace underbrush::fuzz {
namespace {

namespace fs = std::filesystem;
using serve::HttpReply;
using serve::HttpRequest;

const serve::LabelFacts kFacts{"log.ply", "underbrush", 64, "1"};
constexpr size_t kNodes = 9;

// What the server answers with 400 is no fault.
template <class F>
void asked(F read) {
  try {
    read();
  } catch (const std::invalid_argument&) {
  }
}

void read_change(std::string_view bytes) {
  std::vector<uint32_t> values(kFacts.rows);
  asked([&] {
    const serve::StoredChange change = serve::StoredChange::read(bytes);
    change.apply(values, false);
    change.apply(values, true);
  });
}

void read_journal(const Path& path) {
  serve::LabelDocument labels(path, kFacts, {}, kNodes);
  for (; labels.undo(); labels.last_name()) {
  }
  for (; labels.redo(); labels.next_name()) {
  }
}

void read_octree(const Path& path) {
  const serve::OctreeFile file(path);
  const serve::NodeCubes cubes(file);
  serve::Selection selection;
  selection.box = serve::TurnedBox{Vec3(1, 2, 0), Vec3(5, 5, 5), 0.5};
  selection.hidden[0] = true;
  require_data(cubes.rows < 1 << 20, "more rows than a log of this size has");
  serve::find_rows(file, cubes, selection, std::vector<uint32_t>(cubes.rows));
  for (const serve::OctreeNode& node : file.nodes()) serve::read_points(file, node);
}

// A server's answers for a log and a model, with labels in a folder.
class Answers {
 public:
  const HttpReply answer(const HttpRequest& request) {
    if (asked_++ % 1000 == 0) begin();  // The folder fills with what requests export.
    return api_->answer(request);
  }

 private:
  void begin() {
    api_.reset();
    fs::remove_all("labels");
    fs::create_directory("labels");
    api_ = std::make_unique<serve::Api>(
        serve::find_files({"log.ply", "model"}),
        serve::ApiOptions{
            .cache = fs::absolute("cache"), .version = "", .labels = "labels", .program = {}});
    const HttpRequest octree{"GET", "api/octree", {{"file", "0"}}, {}};
    while (api_->answer(octree).body.find("\"ready\"") == std::string::npos) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  std::unique_ptr<serve::Api> api_;
  size_t asked_ = 0;
};

// A request as "METHOD PATH?KEY=VALUE&…", with a range behind a line's end.
void read_request(std::string_view bytes) {
  static Answers answers;
  const auto part = [&](char end) {
    const size_t at = std::min(bytes.find(end), bytes.size());
    std::string out(bytes.substr(0, at));
    bytes.remove_prefix(std::min(at + 1, bytes.size()));
    return out;
  };
  const size_t line = bytes.find('\n');
  HttpRequest request;
  if (line != bytes.npos) request.range = serve::byte_range_of(std::string(bytes.substr(line + 1)));
  bytes = bytes.substr(0, line);
  request.method = part(' ');
  request.path = part('?');
  while (!bytes.empty()) {
    const std::string key = part('=');
    request.query[key] = part('&');
  }
  asked([&] { answers.answer(request); });
}

// A server whose answers say what was asked. HOST and TOKEN stand for its own in a request.
class Server {
 public:
  Server()
      : server_(0,
                [](const HttpRequest& r) {
                  return HttpReply{200, "text/plain", r.path, {}};
                }),
        thread_([this] { server_.run(); }) {
    thread_.detach();
  }
  void ask(std::string request) {
    replace(request, "HOST", "127.0.0.1:" + std::to_string(server_.port()));
    replace(request, "TOKEN", server_.token());
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(uint16_t(server_.port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
      abort();
    ::send(socket, request.data(), request.size(), MSG_NOSIGNAL);
    ::shutdown(socket, SHUT_WR);
    std::array<char, 4096> reply{};
    while (::recv(socket, reply.data(), reply.size(), 0) > 0) {
    }
    ::close(socket);
  }

 private:
  static void replace(std::string& in, std::string_view word, const std::string& by) {
    const size_t at = in.find(word);
    if (at != in.npos) in.replace(at, word.size(), by);
  }
  serve::HttpServer server_;
  std::thread thread_;
};

void ask_server(std::string_view bytes) {
  static auto* const kServer = new Server;  // It runs until the process ends.
  kServer->ask(std::string(bytes));
}

const Reader kReaders[] = {
    {"change", "change.message", read_change},
    {"journal", "log.labels", read_journal},
    {"octree", "log.octree", read_octree},
    {"box", "box.json",
     [](std::string_view b) { asked([&] { serve::check_box(std::string(b)); }); }},
    {"request", "requests/*", read_request},
    {"http", "http/*", ask_server},
};

constexpr const char* kRequests[] = {
    "GET api/files",
    "GET api/octree/data?file=0\nbytes=0-100",
    "GET api/preview?file=0",
    "GET api/beams?file=0&run=0",
    "GET api/beam?file=0&row=3",
    "GET api/trace?file=0&row=3&world=1&seed=2",
    "GET api/errors?file=0&other=0&nodes=0,1",
    "GET api/echoes?file=0&row=3&world=1&seed=1&sensor=hdl-64e",
    "GET api/range_image?file=0&run=0&world=1&seed=1",
    "GET api/trajectory?file=0",
    "GET api/world?file=1",
    "GET api/actors?file=1&edits=[{\"edit\":\"remove\",\"actor\":\"car-1\"}]",
    "POST api/actors/write?file=1&name=edits.json&edits=[]",
    "GET api/ellipsoids?file=1&model=0",
    "GET api/ground?file=1&model=0",
    "GET api/labels?file=0&since=0",
    "GET api/labels/data?file=0&nodes=0",
    "GET api/labels/instances?file=0",
    "GET api/labels/count?file=0&box=1,2,0,5,5,5,0.5&hidden=1,2&times=0,1",
    "GET api/labels/count?file=0&slab=0,0,1,-1,2&of_class=0&scan=0",
    "POST api/labels/edit?file=0&revision=0&class=2&instance=new&select=add&stroke=1&name=x",
    ("POST api/labels/edit?file=0&revision=0&class=2&depth=1&width=10&height=10&path=0,0,9,0,9,9"
     "&matrix=1,0,0,0,0,1,0,0,0,0,1,1,0,0,0,1&radius=3"),
    "POST api/labels/undo?file=0&revision=1",
    "POST api/labels/redo?file=0&revision=1",
    "POST api/labels/carry?file=0&revision=0&from_scan=0&scan=1&radius=0.3",
    "POST api/labels/export?file=0&format=label&name=a.label&set=semantickitti",
    ("POST api/labels/box?file=1&revision=0&value={\"class\":\"small_tree\",\"position_m\":[0,0,0],"
     "\"yaw_rad\":0,\"min_m\":[0,0,0],\"max_m\":[1,1,1]}"),
};

constexpr const char* kHttp[] = {
    "GET /TOKEN/api/files?file=0&name=a%20b HTTP/1.1\r\nHost: HOST\r\nRange: bytes=0-9\r\n\r\n",
    "POST /TOKEN/a HTTP/1.1\r\nHost: HOST\r\nOrigin: http://HOST\r\nContent-Length: 0\r\n\r\n"
    "GET /b HTTP/1.1\r\nConnection: close\r\n\r\n",
    "POST /TOKEN/a HTTP/1.1\r\nHost: HOST\r\nTransfer-Encoding: chunked\r\nExpect: 100-continue"
    "\r\n\r\n5\r\nhello\r\n0\r\n\r\n",
};

}  // namespace

std::span<const Reader> readers() { return kReaders; }

void make_seeds() {
  serve::LabelChange change;
  change.nodes = {1, 4};
  change.name = "brush";
  change.stroke = 7;
  for (uint32_t row = 0; row < 60; row += row % 4 == 1 ? 9 : 1)
    change.add(row, 0, row % 3 << 8 | 2);
  write_file("change.message", change.bytes());
  const std::string box =
      R"({"class":"small_tree","position_m":[1,2,3],"yaw_rad":0.5,"min_m":[-1,-1,0],"max_m":[1,1,2]})";
  write_file("box.json", box);
  {
    serve::LabelDocument labels("log.labels", kFacts, {}, kNodes);
    labels.change(change);
    labels.put_box(1, box);
    labels.undo();
    labels.redo();
  }
  io::Input log = io::open_input("log.ply");
  serve::build_octree(*log.beams, "log.octree");
  fs::create_directory("requests");
  fs::create_directory("http");
  size_t k = 0;
  for (const char* text : kRequests) write_file("requests/" + std::to_string(k++), text);
  for (const char* text : kHttp) write_file("http/" + std::to_string(k++), text);
}

}  // namespace underbrush::fuzz
