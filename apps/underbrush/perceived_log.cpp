#include "perceived_log.hpp"

#include <chrono>

#include "underbrush/core/check.hpp"

namespace underbrush::app {

PerceivedLog perceived(BeamSource& log, const perception::LogTruth* truth,
                       const PerceptionSetup& setup,
                       const std::function<void(const perception::MergedCloud&)>& see) {
  using Clock = std::chrono::steady_clock;
  require(truth || !setup.is_model, "perceive: the tracking model needs the truth (--truth)");
  perception::CycleReader reader(log, setup.rig, setup.cycles);
  perception::TrackingModel model(setup.model);
  perception::ObjectPipeline real(setup.real);
  perception::FalsePositives ghosts(setup.ghosts, setup.seed);
  PerceivedLog out;
  perception::MergedCloud cloud;
  perception::TruthFrame frame;
  while (reader.next(cloud)) {
    if (see) see(cloud);
    if (truth) {
      truth->at(reader.scan(), cloud.time_s, reader.cycle_s(), frame);
      out.truth.push_back(perception::list_of_truth(frame, cloud.world_from_vehicle));
    }
    perception::ObjectList list;
    const auto start = Clock::now();
    if (setup.is_model) {
      model.step(cloud, frame, list);
    } else {
      real.step(cloud, list);
    }
    ghosts.step(list);
    out.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    out.points += cloud.size();
    out.lists.push_back(std::move(list));
  }
  return out;
}

}  // namespace underbrush::app
