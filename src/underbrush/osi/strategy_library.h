/// \file
/// The interface of a strategy in a shared library. It is plain C, and messages cross it as encoded
/// bytes, so that the library may be of any language and compiler and use any OSI version from 3.5.
///
/// A library exports the functions below. All calls for one strategy come one after the other. No
/// exception may leave a function.
#ifndef UNDERBRUSH_OSI_STRATEGY_LIBRARY_H
#define UNDERBRUSH_OSI_STRATEGY_LIBRARY_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The version of this interface.
#define UNDERBRUSH_STRATEGY_VERSION 1

/// Returns `UNDERBRUSH_STRATEGY_VERSION`.
int underbrush_strategy_version(void);
/// Makes a strategy from parameters, one "key: value" a line. Returns NULL on failure, with a
/// reason of at most `size` bytes in `error`.
void* underbrush_strategy_new(const char* parameters, char* error, size_t size);
void underbrush_strategy_free(void* strategy);
/// Processes an encoded SensorData. Returns 0 and an encoded SensorData in `out`, which stays valid
/// until the strategy's next call, or returns 1 with a reason in `error`.
int underbrush_strategy_step(void* strategy, const void* data, size_t bytes, const void** out,
                             size_t* out_bytes, char* error, size_t size);
/// Forgets all cycles.
void underbrush_strategy_reset(void* strategy);
/// Returns a copy that goes on as the original does, or NULL.
void* underbrush_strategy_clone(const void* strategy);

#ifdef __cplusplus
}
#endif
#endif
