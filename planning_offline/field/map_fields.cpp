#include "planning_offline/field/map_fields.h"

#include "planning_offline/field/distance_field.h"
#include "planning_offline/field/isovist.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/passage_width.h"

namespace tautline::planning {

MapFields computeFields(const VoxelMap& map, const FieldRequest& request,
                        const Progress& progress) {
  const std::vector<std::uint8_t> obstacles = obstacleCells(map, request.unknown_is_obstacle);
  MapFields fields;
  if (request.distance) {
    const DistanceOptions options{.resolution = map.resolution,
                                  .cap = request.distance_cap,
                                  .solid_border = map.solid_border,
                                  .threads = request.threads};
    fields.distance =
        distanceField(map.shape, obstacles, options, progress, {"distance to obstacles"});
  }
  if (request.width) {
    const WidthOptions options{.resolution = map.resolution,
                               .cap = request.width_cap,
                               .solid_border = map.solid_border,
                               .threads = request.threads};
    fields.width = widthField(map.shape, obstacles, options, progress, {"passage width"});
  }
  if (request.visibility) {
    const IsovistOptions options{.resolution = map.resolution,
                                 .directions = request.visibility_directions,
                                 .cap = request.visibility_cap,
                                 .threads = request.threads};
    fields.visibility = isovistField(map.shape, obstacles, options, progress, {"visibility"});
  }
  return fields;
}

}  // namespace tautline::planning
