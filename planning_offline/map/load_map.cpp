#include "planning_offline/map/load_map.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "common/error.h"
#include "common/mission/mission_file.h"
#include "common/toml/toml_file.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/map/line_reader.h"
#include "planning_offline/map/movingai.h"
#include "planning_offline/map/octomap_file.h"
#include "planning_offline/map/raster.h"
#include "planning_offline/map/scene_map.h"

namespace tautline::planning {
namespace {

using Loader = VoxelMap (*)(std::string_view bytes, const std::string& file,
                            const LoadOptions& options);

struct Kind {
  const char* extension;
  const char* what;
  std::string_view start;  ///< Of the content.
  Loader load;
};

constexpr std::array<Kind, 4> kKinds{{
    {".bt", "an OctoMap binary tree", kOctomapBinaryHeader, octomapMap},
    {".ot", "an OctoMap tree", kOctomapFullHeader, octomapMap},
    {".map", "a MovingAI grid map", "type ", movingAiPlane},
    {".3dmap", "a MovingAI voxel map", "voxel ", movingAiSpace},
}};
constexpr Kind kScene{".toml", "a scene", "", sceneMap};

/// Text of any kind, so that the TOML reader's own errors make sense.
bool isText(std::string_view bytes) {
  return std::none_of(bytes.begin(), bytes.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' &&
            std::string_view("\t\r\n\f").find(c) == std::string_view::npos);
  });
}

/// By the content, of which the name must say the same if it says anything.
const Kind& kindOf(const std::filesystem::path& path, std::string_view bytes) {
  const std::string extension = path.extension().string();
  const auto has_start = [&](const Kind& kind) { return bytes.starts_with(kind.start); };
  const auto has_name = [&](const Kind& kind) { return kind.extension == extension; };
  const auto* const content = std::find_if(kKinds.begin(), kKinds.end(), has_start);
  const auto* const name = std::find_if(kKinds.begin(), kKinds.end(), has_name);
  const bool scene = has_name(kScene);
  if (bytes.empty()) throw InputError({.file = path.string(), .problem = "is an empty file"});
  if (content == kKinds.end()) {
    if (scene && isText(bytes)) return kScene;
    const Kind* const expected = scene ? &kScene : name == kKinds.end() ? nullptr : name;
    throw InputError({.file = path.string(),
                      .problem = "is not " + std::string(expected ? expected->what : "a map") +
                                 ": it starts with " + shownText(bytes),
                      .allowed = ".bt, .ot, .map, .3dmap, .scene.toml"});
  }
  if (scene || (name != kKinds.end() && name != content)) {
    throw InputError({.file = path.string(),
                      .problem = "is called " + extension + " and is " + content->what,
                      .remedy = "rename it to " + std::string(content->extension)});
  }
  return *content;
}

std::string readMapFile(const std::filesystem::path& path, std::int64_t limit) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_directory(path, error)) {
    if (!std::filesystem::is_regular_file(path, error))
      throw InputError({.file = path.string(), .problem = "is not a regular file"});
    const auto size = std::filesystem::file_size(path, error);
    if (!error) {
      checkMemory(path.string(), "its bytes", static_cast<double>(size), limit,
                  "allow more memory");
    }
  }
  return readTextFile(path);
}

void checkResolution(const std::filesystem::path& path, const LoadOptions& options) {
  if (!options.resolution || kResolutionRange.contains(*options.resolution)) return;
  throw InputError({.file = path.string(),
                    .key = "resolution",
                    .problem = "is " + tomlText(*options.resolution),
                    .allowed = rangeText(kResolutionRange) + " m"});
}

/// Somewhere to be: at least free or unknown cells beside others.
void checkNotEmpty(const VoxelMap& map) {
  const auto count = [&](CellState s) { return std::count(map.cells.begin(), map.cells.end(), s); };
  if (count(CellState::kFree) > 0) return;
  const auto occupied = count(CellState::kOccupied);
  const auto all = static_cast<std::ptrdiff_t>(map.cells.size());
  if (occupied > 0 && occupied < all) return;
  throw InputError({.file = map.file,
                    .problem = occupied == 0 ? "is an empty map: nothing is known in this part"
                                             : "is an empty map: all cells are occupied",
                    .remedy = occupied == 0 ? "choose another crop or slice"
                                            : "choose a finer resolution or another part"});
}

}  // namespace

VoxelMap loadMap(const std::filesystem::path& path, const LoadOptions& options) {
  checkResolution(path, options);
  const std::string bytes = readMapFile(path, options.memory_limit);
  VoxelMap map = kindOf(path, bytes).load(bytes, path.string(), options);
  if (map.name.empty()) map.name = path.stem().string();
  map.hash = fnv1a(bytes);
  checkNotEmpty(map);
  return map;
}

}  // namespace tautline::planning
