/// \file
/// The structs of Arrow's C data interface and of its stream interface, and their capsules.
#include "arrow.hpp"

#include <cerrno>

namespace underbrush::python {
namespace {

// As Arrow's specification prints them ("The Arrow C data interface").
struct ArrowSchema {
  const char* format;
  const char* name;
  const char* metadata;
  int64_t flags;
  int64_t n_children;
  ArrowSchema** children;
  ArrowSchema* dictionary;
  void (*release)(ArrowSchema*);
  void* private_data;
};

struct ArrowArray {
  int64_t length;
  int64_t null_count;
  int64_t offset;
  int64_t n_buffers;
  int64_t n_children;
  const void** buffers;
  ArrowArray** children;
  ArrowArray* dictionary;
  void (*release)(ArrowArray*);
  void* private_data;
};

struct ArrowArrayStream {
  int (*get_schema)(ArrowArrayStream*, ArrowSchema*);
  int (*get_next)(ArrowArrayStream*, ArrowArray*);
  const char* (*get_last_error)(ArrowArrayStream*);
  void (*release)(ArrowArrayStream*);
  void* private_data;
};

constexpr int64_t kNullable = 2;

/// What a struct of Arrow's points to. A reader may take children over, which then release
/// themselves.
template <class Struct>
struct Parts {
  std::string format = {}, name = {}, metadata = {};
  std::shared_ptr<const void> owner = {};
  std::vector<const void*> buffers = {};
  std::vector<Struct> children = {};
  std::vector<Struct*> pointers = {};
};

template <class Struct>
void release(Struct* s) {
  auto* parts = static_cast<Parts<Struct>*>(s->private_data);
  for (Struct& child : parts->children) {
    if (child.release) child.release(&child);
  }
  delete parts;
  s->release = nullptr;
}

template <class Struct>
void set_children(Struct& s, Parts<Struct>& parts) {
  for (Struct& child : parts.children) parts.pointers.push_back(&child);
  s.n_children = int64_t(parts.pointers.size());
  s.children = parts.pointers.data();
  s.release = release<Struct>;
  s.private_data = &parts;
}

ArrowSchema schema_of(std::string format, std::string name, std::string metadata, int64_t flags,
                      std::vector<ArrowSchema> children) {
  auto* parts = new Parts<ArrowSchema>{
      std::move(format), std::move(name), std::move(metadata), {}, {}, std::move(children)};
  ArrowSchema s{};
  s.format = parts->format.c_str();
  s.name = parts->name.c_str();
  s.metadata = parts->metadata.empty() ? nullptr : parts->metadata.c_str();
  s.flags = flags;
  set_children(s, *parts);
  return s;
}

ArrowArray array_of(int64_t length, int64_t nulls, std::vector<const void*> buffers,
                    const std::shared_ptr<const void>& owner, std::vector<ArrowArray> children) {
  auto* parts = new Parts<ArrowArray>{{}, {}, {}, owner, std::move(buffers), std::move(children)};
  ArrowArray a{};
  a.length = length;
  a.null_count = nulls;
  a.n_buffers = int64_t(parts->buffers.size());
  a.buffers = parts->buffers.data();
  set_children(a, *parts);
  return a;
}

/// Returns one key and its value as Arrow codes them: their number, then each with its length.
std::string coded(const std::string& key, const std::string& value) {
  std::string out;
  const auto add = [&](size_t n) {
    const auto number = int32_t(n);
    out.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  add(1);
  for (const std::string& text : {key, value}) {
    add(text.size());
    out += text;
  }
  return out;
}

ArrowSchema schema_of(const ArrowTable& table) {
  std::vector<ArrowSchema> children;
  for (const ArrowColumn& c : table.columns) {
    const int64_t flags = c.valid ? kNullable : 0;
    if (c.width == 0) {
      children.push_back(schema_of(c.format, c.name, {}, flags, {}));
    } else {
      children.push_back(schema_of("+w:" + std::to_string(c.width), c.name, {}, flags,
                                   {schema_of(c.format, "item", {}, 0, {})}));
    }
  }
  return schema_of("+s", "",
                   table.metadata.empty() ? std::string() : coded("underbrush", table.metadata), 0,
                   std::move(children));
}

ArrowArray array_of(const ArrowTable& table) {
  std::vector<ArrowArray> children;
  for (const ArrowColumn& c : table.columns) {
    if (c.width == 0) {
      children.push_back(array_of(table.rows, c.nulls, {c.valid, c.values}, table.owner, {}));
    } else {
      children.push_back(
          array_of(table.rows, c.nulls, {c.valid}, table.owner,
                   {array_of(table.rows * c.width, 0, {nullptr, c.values}, table.owner, {})}));
    }
  }
  return array_of(table.rows, 0, {nullptr}, table.owner, std::move(children));
}

/// A stream's first table, which is given once, and the function of the others.
struct Stream {
  ArrowTable first;
  ArrowNext next;
  bool begun = false;
  std::string error = {};
};

Stream& of(ArrowArrayStream* s) { return *static_cast<Stream*>(s->private_data); }

int next_of(ArrowArrayStream* s, ArrowArray* out) {
  Stream& stream = of(s);
  *out = {};
  try {
    if (!stream.begun) {
      stream.begun = true;
      *out = array_of(stream.first);
      stream.first.owner.reset();
      return 0;
    }
    if (!stream.next) return 0;
    if (const std::optional<ArrowTable> table = stream.next()) *out = array_of(*table);
    return 0;
  } catch (const std::exception& e) {
    stream.error = e.what();
    return EIO;
  }
}

/// Makes a capsule of Arrow's name that owns a struct and releases what no reader took over.
template <class Struct>
nb::object capsule(const Struct& s, const char* name) {
  return nb::capsule(new Struct(s), name, [](void* p) noexcept {
    auto* owned = static_cast<Struct*>(p);
    if (owned->release) owned->release(owned);
    delete owned;
  });
}

}  // namespace

std::shared_ptr<const void> kept_alive(nb::handle object) {
  object.inc_ref();
  return {object.ptr(), [](PyObject* kept) {
            if (!Py_IsInitialized()) return;  // Python has ended, and its objects with it.
            const nb::gil_scoped_acquire lock;
            nb::handle(kept).dec_ref();
          }};
}

nb::object arrow_schema(const ArrowTable& table) {
  return capsule(schema_of(table), "arrow_schema");
}

nb::object arrow_array(const ArrowTable& table) {
  return nb::make_tuple(arrow_schema(table), capsule(array_of(table), "arrow_array"));
}

nb::object arrow_stream(ArrowTable first, ArrowNext next) {
  ArrowArrayStream s{};
  s.get_schema = [](ArrowArrayStream* self, ArrowSchema* out) {
    *out = schema_of(of(self).first);
    return 0;
  };
  s.get_next = next_of;
  s.get_last_error = [](ArrowArrayStream* self) -> const char* {
    return of(self).error.empty() ? nullptr : of(self).error.c_str();
  };
  s.release = [](ArrowArrayStream* self) {
    delete static_cast<Stream*>(self->private_data);
    self->release = nullptr;
  };
  s.private_data = new Stream{std::move(first), std::move(next)};
  return capsule(s, "arrow_array_stream");
}

}  // namespace underbrush::python
