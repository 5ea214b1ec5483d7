#include "underbrush/osi/trace.hpp"

#include <array>
#include <cstring>
#include <protozero/pbf_reader.hpp>
#include <protozero/pbf_writer.hpp>

#include "underbrush/core/check.hpp"

namespace underbrush::osi {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t kMostMessageBytes = uint64_t(1) << 31;

// The kind of which this field is a sign: GroundTruth has moving objects where SensorData has a
// sensor's number, and so on. Fields come in ascending order, so 5 speaks before 7 and 8.
std::optional<MessageType> type_of_field(protozero::pbf_reader& r) {
  const uint32_t tag = r.tag();
  const bool is_part = r.wire_type() == protozero::pbf_wire_type::length_delimited;
  if (tag >= 1000 && tag <= 1004) return MessageType::kSensorView;
  if (tag == 13) return is_part ? MessageType::kSensorData : MessageType::kGroundTruth;
  if (tag >= 21 && tag <= 29 && is_part) return MessageType::kSensorData;
  if (!is_part || (tag != 5 && tag != 7 && tag != 8)) return std::nullopt;
  protozero::pbf_reader part = r.get_message();
  if (!part.next()) return std::nullopt;
  const bool holds_part = part.wire_type() == protozero::pbf_wire_type::length_delimited;
  if (tag == 5) return holds_part ? MessageType::kGroundTruth : MessageType::kSensorData;
  if (tag == 8) return holds_part ? MessageType::kSensorData : MessageType::kSensorView;
  return holds_part ? std::optional(MessageType::kSensorView) : std::nullopt;
}

}  // namespace

std::string_view code(MessageType type) {
  constexpr std::array<std::string_view, 3> kCodes{"sv", "sd", "gt"};
  return kCodes[size_t(type)];
}

std::string_view name(MessageType type) {
  constexpr std::array<std::string_view, 3> kNames{"SensorView", "SensorData", "GroundTruth"};
  return kNames[size_t(type)];
}

std::optional<MessageType> type_of_message(std::string_view bytes) {
  try {
    protozero::pbf_reader r(protozero::data_view(bytes.data(), bytes.size()));
    while (r.next()) {
      const size_t before = r.length();
      if (const auto type = type_of_field(r)) return type;
      if (r.length() == before) r.skip();
    }
  } catch (const protozero::exception&) {
  }
  return std::nullopt;
}

std::optional<MessageType> type_of_name(const fs::path& path) {
  const std::string text = "_" + path.stem().string() + "_";
  for (const MessageType type :
       {MessageType::kSensorView, MessageType::kSensorData, MessageType::kGroundTruth}) {
    if (text.find("_" + std::string(code(type)) + "_") != std::string::npos) return type;
  }
  return std::nullopt;
}

bool is_trace_file(const fs::path& path) { return path.extension() == ".osi"; }

TraceReader::TraceReader(const fs::path& path) : file_(path) {
  std::string first;
  if (!next(first)) throw FormatError(file_.name(), "", "the trace has no messages");
  rewind();
  const auto named = type_of_name(path), found = type_of_message(first);
  if (!named && !found) {
    throw FormatError(file_.name(), "message 1",
                      "the kind of message is in neither the name nor the content: SensorView, "
                      "SensorData or GroundTruth");
  }
  type_ = named ? *named : *found;
}

void TraceReader::rewind() {
  at_ = 0;
  read_ = 0;
}

bool TraceReader::next(std::string& message) {
  if (at_ == file_.size()) return false;
  const std::string number = "message " + std::to_string(read_ + 1);
  place_ = file_.name() + ": " + number;
  std::array<uint8_t, 4> head{};
  if (file_.size() - at_ < head.size()) throw FormatError(file_.name(), number, "truncated");
  file_.read(at_, head.data(), head.size());
  const uint64_t size = uint64_t(head[0]) | uint64_t(head[1]) << 8 | uint64_t(head[2]) << 16 |
                        uint64_t(head[3]) << 24;
  at_ += head.size();
  if (size >= kMostMessageBytes) throw FormatError(file_.name(), number, "of 2 GiB or more");
  if (size > file_.size() - at_) throw FormatError(file_.name(), number, "truncated");
  message.resize(size);
  file_.read(at_, message.data(), size);
  at_ += size;
  ++read_;
  return true;
}

TraceWriter::TraceWriter(const fs::path& path, std::string provenance)
    : provenance_(std::move(provenance)), file_(path), out_(file_.temporary(), path.string()) {}

void TraceWriter::write(std::string_view message) {
  if (provenance_.empty()) return put(message);
  std::string marked;
  protozero::pbf_writer(marked).add_string(kProvenanceField, provenance_);
  marked += message;
  provenance_.clear();
  put(marked);
}

void TraceWriter::put(std::string_view message) {
  require(message.size() < kMostMessageBytes, "osi: a message of 2 GiB or more");
  std::array<uint8_t, 4> head{};
  for (size_t k = 0; k < 4; ++k) head[k] = uint8_t(message.size() >> (8 * k));
  out_.append(head.data(), head.size());
  out_.append(message.data(), message.size());
  ++written_;
}

void TraceWriter::close() {
  out_.close();
  file_.commit();
}

}  // namespace underbrush::osi
