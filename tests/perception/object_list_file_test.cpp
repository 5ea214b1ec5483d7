#include "underbrush/perception/object_list_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/perception/object_columns.hpp"

namespace underbrush::perception {
namespace {
namespace fs = std::filesystem;

std::vector<ObjectList> some_lists() {
  Stream random(2);
  std::vector<ObjectList> lists;
  for (int k = 0; k < 4; ++k) {
    ObjectList list;
    list.time_s = 1e9 + 0.1 * k;
    list.available_s = list.time_s + 0.05;
    list.world_from_vehicle = {
        Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized())),
        {1.5, 2.5, 1.0 / 3}};
    for (int i = 0; i < k; ++i) {  // The first list is empty.
      TrackedObject o;
      o.id = (uint64_t(1) << 48) + uint64_t(i);
      o.truth_id = uint64_t(i);
      o.label = ObjectClass(1 + i);
      o.probability[size_t(i) + 1] = 0.75f;
      o.probability[6] = 0.25f;
      o.is_measured = i % 2 == 0;
      o.points = uint32_t(10 * i);
      for (const ObjectColumn& c : object_columns()) c.value(o) = random.normal();
      list.objects.push_back(o);
    }
    lists.push_back(list);
  }
  return lists;
}

class ListFile : public testing::TestWithParam<const char*> {
 protected:
  ~ListFile() override { fs::remove(path_); }
  fs::path path_ = fs::temp_directory_path() / ("lists_" + std::to_string(::getpid()) + GetParam());
};

TEST_P(ListFile, ReadsWhatItWrote) {
  const auto lists = some_lists();
  write_object_lists(path_, lists, "{\"program\": \"test\"}");
  EXPECT_TRUE(is_object_list_file(path_));
  const auto read = read_object_lists(path_);
  ASSERT_EQ(read.size(), lists.size());
  for (size_t k = 0; k < lists.size(); ++k) {
    EXPECT_EQ(read[k].time_s, lists[k].time_s);
    EXPECT_EQ(read[k].available_s, lists[k].available_s);
    EXPECT_EQ(read[k].world_from_vehicle.translation, lists[k].world_from_vehicle.translation);
    EXPECT_TRUE(read[k].world_from_vehicle.rotation.isApprox(lists[k].world_from_vehicle.rotation));
    ASSERT_EQ(read[k].objects.size(), lists[k].objects.size());
    for (size_t i = 0; i < lists[k].objects.size(); ++i) {
      TrackedObject a = lists[k].objects[i], b = read[k].objects[i];
      EXPECT_EQ(a.id, b.id);
      EXPECT_EQ(a.truth_id, b.truth_id);
      EXPECT_EQ(a.label, b.label);
      EXPECT_EQ(a.probability, b.probability);
      EXPECT_EQ(a.is_measured, b.is_measured);
      EXPECT_EQ(a.points, b.points);
      for (const ObjectColumn& c : object_columns()) EXPECT_EQ(c.value(a), c.value(b)) << c.name;
    }
  }
}

TEST_P(ListFile, EveryTruncatedFileIsRefusedOrShorter) {
  const auto lists = some_lists();
  write_object_lists(path_, lists, "");
  std::ifstream in(path_);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  for (size_t n = 0; n < text.size(); n += 211) {
    std::ofstream(path_) << text.substr(0, n);
    try {
      EXPECT_LE(read_object_lists(path_).size(), lists.size());
    } catch (const FormatError&) {
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ListFile, testing::Values(".csv", ".json"));

TEST(ListCsv, NamesTheLineOfAFault) {
  const fs::path path = fs::temp_directory_path() / ("bad_" + std::to_string(::getpid()) + ".csv");
  const auto reason = [&](const std::string& rows) {
    std::ofstream(path) << "time,id,class,x,y,z,yaw,length,width,height\n" << rows;
    try {
      read_object_lists(path);
    } catch (const FormatError& e) {
      return e.place() + ": " + e.reason();
    }
    return std::string("accepted");
  };
  EXPECT_EQ(reason("0,1,car,0,0,0,0,4,2,1\n"), "accepted");
  EXPECT_EQ(reason("0,1,tank,0,0,0,0,4,2,1\n"), "line 2: unknown class 'tank'");
  EXPECT_EQ(reason("0,1,car,0,0,0,0,4,2,1\n0,2,car,nan,0,0,0,4,2,1\n"),
            "line 3: column x: not a finite number: 'nan'");
  EXPECT_EQ(reason("0,1,car,0,0\n"), "line 2: expected 10 values, found 5");
  EXPECT_EQ(reason("1,1,car,0,0,0,0,4,2,1\n0,1,car,0,0,0,0,4,2,1\n"), "line 3: times must ascend");
  EXPECT_EQ(reason("0,-1,car,0,0,0,0,4,2,1\n"), "line 2: column id: not a whole number");
  fs::remove(path);
}

}  // namespace
}  // namespace underbrush::perception
