/// \file
/// The words of the option `--seed`.
#pragma once
namespace underbrush {
/// What `--seed` is.
inline constexpr const char* kSeedHelp = "Seed of all random numbers";
}  // namespace underbrush
