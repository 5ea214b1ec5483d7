#include "underbrush/compact/compact_file.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_rows.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

class CompactRows : public LogRows {
 public:
  explicit CompactRows(const std::filesystem::path& path) : file_(path), reader_(file_) {
    PlyHeader header;
    constexpr std::string_view kComment = "comment ";
    for_each_line(reader_.text(), [&](size_t, std::string_view line) {
      if (line.starts_with(kComment)) header.comments.emplace_back(line.substr(kComment.size()));
    });
    comments = comments_from_header(file_.name(), header);
    if (!comments.ours) throw FormatError(file_.name(), "index", "it does not describe the log");
  }

  const std::string& file() const override { return file_.name(); }
  size_t size() const override { return reader_.rows(); }
  const BeamLog& empty() const override { return reader_.empty(); }
  void read(size_t first, BeamLog& out, std::vector<uint8_t>&) const override {
    reader_.read(first, out);
  }
  std::vector<std::pair<size_t, size_t>> ranges(const LogWindow& window) const override {
    std::vector<std::pair<size_t, size_t>> out;
    const compact::Box place{window.least, window.most};
    size_t first = 0;
    for (const compact::ChunkFacts& c : reader_.chunks()) {
      const size_t end = std::min(first + compact::kChunkRows, size());
      const bool in_time = c.first_s <= window.last_s && c.last_s >= window.first_s;
      if (in_time && (!window.has_place() || c.ends.meets(place))) out.emplace_back(first, end);
      first = end;
    }
    return out;
  }

 private:
  InputFile file_;
  compact::Reader reader_;
};

class CompactSink : public LogSink {
 public:
  CompactSink(OutputFile& out, const LogComments& comments) : writer_(out, comments.info) {}
  void write(const BeamLog& chunk) override { writer_.write(chunk); }
  void finish(const LogComments& comments) override {
    writer_.finish(text_from_comments(comments));
  }

 private:
  compact::Writer writer_;
};

bool has_magic(const std::filesystem::path& path) { return compact::is_compact(InputFile(path)); }

std::unique_ptr<LogRows> open_rows(const std::filesystem::path& path) {
  return std::make_unique<CompactRows>(path);
}

std::unique_ptr<LogSink> begin_file(OutputFile& out, const LogComments& comments) {
  return std::make_unique<CompactSink>(out, comments);
}

}  // namespace

const CompactFormat* compact_format() {
  static constexpr CompactFormat kFormat = {has_magic, open_rows, begin_file};
  return &kFormat;
}

}  // namespace underbrush::io
