/// \file
/// This file reads and writes OSI's trace files: messages one after the other, each behind its
/// length (uint32, little-endian).
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "underbrush/core/file.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::osi {

/// The messages that a trace may have.
enum class MessageType : uint8_t { kSensorView, kSensorData, kGroundTruth };
/// The code of a message in the names of traces: "sv", "sd" or "gt".
std::string_view code(MessageType type);
/// The message's name in OSI, such as "SensorView".
std::string_view name(MessageType type);

/// Reads the messages of a trace in order.
class TraceReader {
 public:
  /// Throws `FormatError` where the file cannot be read or is empty.
  explicit TraceReader(const std::filesystem::path& path);
  /// Replaces `message` by the bytes of the next one. Returns false at the end. Throws
  /// `FormatError` where the file ends within a message.
  bool next(std::string& message);
  /// The place of the last message, for errors: "FILE: message N".
  const std::string& place() const { return place_; }
  /// Number of messages read so far.
  size_t read() const { return read_; }
  void rewind();
  /// The kind of messages. It is taken from the code in the file's name, as
  /// TIME_CODE_VERSIONS_FRAMES_NAME.osi has it; without one, from the first message.
  MessageType type() const { return type_; }

 private:
  InputFile file_;
  uint64_t at_ = 0;
  size_t read_ = 0;
  std::string place_;
  MessageType type_;
};

/// Returns the kind of message of these bytes, by the fields that only one kind has; nothing if
/// they could be of any.
std::optional<MessageType> type_of_message(std::string_view bytes);
/// The kind of messages by the name of a trace.
std::optional<MessageType> type_of_name(const std::filesystem::path& path);
/// Whether a file has the extension of traces, .osi.
bool is_trace_file(const std::filesystem::path& path);

/// The number of the field with the provenance of a trace, of the range that protobuf leaves to
/// private use. Other readers skip it.
inline constexpr uint32_t kProvenanceField = 50001;

/// Writes a trace, which appears as a whole with `close()`.
class TraceWriter {
 public:
  /// `provenance` is JSON; unless it is empty, it begins the first message as a field that is not
  /// one of OSI (`kProvenanceField`). Throws `IoError`.
  explicit TraceWriter(const std::filesystem::path& path, std::string provenance = "");
  /// Throws `std::invalid_argument` for a message of 2 GiB or more, which OSI does not allow.
  void write(std::string_view message);
  void close();
  size_t written() const { return written_; }

 private:
  void put(std::string_view message);
  std::string provenance_;
  io::AtomicFile file_;
  OutputFile out_;
  size_t written_ = 0;
};

}  // namespace underbrush::osi
