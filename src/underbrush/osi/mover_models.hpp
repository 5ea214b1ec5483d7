/// \file
/// The shapes of the moving objects of a ground truth. This file is internal to the module.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "underbrush/elements/scene.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/sensor_view.hpp"

namespace underbrush::osi {

/// Returns a mesh as a model.
elements::Model mesh_model(const std::vector<Vec3f>& vertices,
                           const std::vector<std::array<uint32_t, 3>>& triangles);

/// The models of movers by name: meshes, which are fitted to each mover's box, and fitted models,
/// whose origin is placed in the middle of the box. A scene of moving instances alone, such as
/// learnt actors, has fitted models with the times at which they are there.
class MoverModels {
 public:
  /// Reads the models and meshes of a folder, or a scene; "" means that there are none. Throws
  /// `FormatError` and `std::filesystem::filesystem_error`.
  explicit MoverModels(const std::string& folder);

  /// Returns the model that is named as the object's own, else as its class, else a box. Of models
  /// of one name it is one that is there at the time (s), else the first.
  elements::Model model(const MovingObject& m, double time_s) const;

 private:
  struct Fitted {
    elements::Mover times;
    elements::Model model;
  };
  void read_scene(const std::string& folder);

  std::map<std::string, std::vector<Fitted>> fitted_;
  std::map<std::string, elements::Model> meshes_;
};

}  // namespace underbrush::osi
