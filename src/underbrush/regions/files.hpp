/// \file
/// Names of the files of a world. This file is internal to the module.
#pragma once

namespace underbrush::regions {

inline constexpr const char* kIndexFile = "index.json";
inline constexpr const char* kCommonFolder = "common";
inline constexpr const char* kNumbersFile = "numbers.ply";
inline constexpr const char* kInstancesFile = "instances.ply";
/// The elements of a file of numbers: those of the model's elements by kind, and of the instances.
inline constexpr const char* kNumberElements[] = {"ground", "surface", "ellipsoids", "instances"};
inline constexpr const char* kNumberColumn = "number";

}  // namespace underbrush::regions
