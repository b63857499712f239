#include "planning_offline/map/octomap_file.h"

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <sstream>
#include <vector>

#include "common/error.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/map/line_reader.h"
#include "planning_offline/map/raster.h"

namespace tautline::planning {
namespace {

constexpr int kDepth = 16;              // levels of every OctoMap tree below its root
constexpr int kRootSize = 1 << kDepth;  // [leaves]
constexpr double kBytesPerNode = 64.0;  // of a tree in memory: node, child pointers, heap overhead

struct Header {
  bool binary{false};
  std::string tree;
  std::int64_t nodes{-1};
  double resolution{0.0};
  std::string_view data;
};

Header readHeader(std::string_view bytes, const std::string& file) {
  Header header;
  header.binary = bytes.starts_with(kOctomapBinaryHeader);
  LineReader lines(file, bytes);
  while (lines.next()) {
    const std::vector<std::string_view> words = lines.words();
    if (words.empty() || words[0].starts_with('#')) continue;
    if (words[0] == "data" && words.size() == 1) {
      if (header.tree.empty() || header.nodes < 0 || header.resolution == 0.0)
        throw lines.error("'data' before id, size and res were all given");
      header.data = bytes.substr(
          static_cast<std::size_t>(lines.line().data() + lines.line().size() - bytes.data()));
      header.data.remove_prefix(std::min(header.data.find('\n') + 1, header.data.size()));
      return header;
    }
    if (words.size() != 2 || !(words[0] == "id" || words[0] == "size" || words[0] == "res"))
      throw lines.error("is " + shownText(lines.line()), "id, size, res or data");
    if (words[0] == "id") {
      header.tree = words[1];
    } else if (words[0] == "size") {
      header.nodes = integerOf(words[1]).value_or(-1);
      if (header.nodes < 0)
        throw lines.error("size is " + shownText(words[1]), "a number of nodes");
    } else {
      header.resolution = numberOf(words[1]).value_or(-1.0);
      if (!kResolutionRange.contains(header.resolution))
        throw lines.error("res is " + shownText(words[1]), rangeText(kResolutionRange) + " m");
    }
  }
  throw lines.error("the file ends within its header", "", "it is truncated; get it again");
}

/// Walks over the bytes of a tree as its reader will. OctoMap's own reader trusts them: it would
/// recurse for ever at the end of a truncated file, and take a node without children for free.
class TreeCheck {
 public:
  /// `payload`: bytes of a node before its children's mask; only in `.ot`.
  TreeCheck(const std::string& file, const Header& header, std::size_t payload)
      : file_(file), header_(header), payload_(payload) {}

  /// Throws InputError unless the bytes are one tree with the promised number of nodes.
  void check() {
    nodes_ = 1;
    header_.binary ? binaryNode(0) : fullNode(0);
    if (at_ != header_.data.size())
      fail(std::to_string(header_.data.size() - at_) + " bytes follow after the last node");
    if (nodes_ != header_.nodes) {
      fail("has " + std::to_string(nodes_) + " nodes; its header promises " +
           std::to_string(header_.nodes));
    }
    if (nodes_ == 1)
      throw InputError({.file = file_, .problem = "is an empty map: its tree is a root alone"});
  }

  /// Cubes that the tree consists of, known and unknown, at most.
  [[nodiscard]] std::int64_t cubes() const noexcept { return 8 * inner_ + 1; }

 private:
  [[noreturn]] void fail(std::string problem) const {
    throw InputError({.file = file_,
                      .problem = std::move(problem),
                      .remedy = "the file is damaged or truncated; get it again"});
  }

  unsigned byte() {
    if (at_ == header_.data.size()) {
      fail("the file ends after " + std::to_string(nodes_) + " of " +
           std::to_string(header_.nodes) + " nodes");
    }
    return static_cast<unsigned char>(header_.data[at_++]);
  }

  void enter(int depth) {
    ++inner_;
    if (depth == kDepth) fail("the tree is deeper than " + std::to_string(kDepth) + " levels");
  }

  /// Two bits a child: 0 unknown, 1 free, 2 occupied, 3 has children.
  void binaryNode(int depth) {
    enter(depth);
    unsigned mask = byte();
    mask |= byte() << 8;
    if (mask == 0 && depth > 0) fail("a node has no children where it should");
    for (int child = 0; child < 8; ++child) {
      if (((mask >> (2 * child)) & 3U) != 0) ++nodes_;
    }
    for (int child = 0; child < 8; ++child) {
      if (((mask >> (2 * child)) & 3U) == 3U) binaryNode(depth + 1);
    }
  }

  void fullNode(int depth) {
    for (std::size_t i = 0; i < payload_; ++i) byte();
    const unsigned mask = byte();
    if (mask == 0) return;
    enter(depth);
    for (int child = 0; child < 8; ++child) {
      if (((mask >> child) & 1U) == 0) continue;
      ++nodes_;
      fullNode(depth + 1);
    }
  }

  const std::string& file_;
  const Header& header_;
  std::size_t payload_;
  std::size_t at_{0};
  std::int64_t nodes_{0};
  std::int64_t inner_{0};
};

/// A leaf of the tree, or a part of space that the tree does not know. Lower corner and size in
/// leaves of the deepest level, file axes, from the tree's lower corner.
struct Cube {
  Eigen::Vector3i corner;
  int size{0};
  CellState state{CellState::kUnknown};
};

template <class Tree>
void collect(const Tree& tree, const typename Tree::NodeType* node, const Cube& cube,
             const std::string& file, std::vector<Cube>& cubes) {
  if (!tree.nodeHasChildren(node)) {
    if (std::isnan(node->getLogOdds()))
      throw InputError({.file = file, .problem = "the occupancy of a voxel is not a number"});
    cubes.push_back({cube.corner, cube.size,
                     tree.isNodeOccupied(node) ? CellState::kOccupied : CellState::kFree});
    return;
  }
  const int half = cube.size / 2;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3i step(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    const auto index = static_cast<unsigned>(i);
    const Cube child{cube.corner + half * step, half, CellState::kUnknown};
    if (tree.nodeChildExists(node, index)) {
      collect(tree, tree.getNodeChild(node, index), child, file, cubes);
    } else {
      cubes.push_back(child);
    }
  }
}

template <class Tree>
std::vector<Cube> readTree(const Header& header, const std::string& file) {
  Tree tree(header.resolution);
  std::istringstream data{std::string(header.data)};
  header.binary ? tree.readBinaryData(data) : tree.readData(data);
  std::vector<Cube> cubes;
  collect(tree, tree.getRoot(), {{0, 0, 0}, kRootSize, CellState::kUnknown}, file, cubes);
  return cubes;
}

/// In M [m].
Bounds boundsOf(const Cube& cube, double resolution) {
  const Eigen::Array3i lo = cube.corner.array() - kRootSize / 2;
  return {fromZUp(resolution * lo.cast<double>()),
          fromZUp(resolution * (lo + cube.size).cast<double>())};
}

Bounds knownSpace(const std::vector<Cube>& cubes, double resolution, const std::string& file) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Bounds known{Eigen::Vector3d::Constant(kFar), Eigen::Vector3d::Constant(-kFar)};
  for (const Cube& cube : cubes) {
    if (cube.state == CellState::kUnknown) continue;
    const Bounds bounds = boundsOf(cube, resolution);
    known.min = known.min.cwiseMin(bounds.min);
    known.max = known.max.cwiseMax(bounds.max);
  }
  if (known.min.x() > known.max.x())
    throw InputError({.file = file, .problem = "is an empty map: nothing in it is known"});
  return known;
}

/// Bytes of a node in `.ot` before the mask of its children.
std::size_t payloadOf(const Header& header, const std::string& file) {
  if (header.tree == "ColorOcTree") return sizeof(float) + 3;
  if (header.tree == "OcTree" || header.tree == "OcTreeStamped") return sizeof(float);
  throw InputError({.file = file,
                    .key = "id",
                    .problem = "is " + shownText(header.tree),
                    .allowed = "OcTree, ColorOcTree, OcTreeStamped"});
}

}  // namespace

VoxelMap octomapMap(std::string_view bytes, const std::string& file, const LoadOptions& options) {
  const Header header = readHeader(bytes, file);
  const std::size_t payload = payloadOf(header, file);
  if (header.nodes == 0)
    throw InputError({.file = file, .problem = "is an empty map: its tree has no nodes"});
  TreeCheck tree(file, header, payload);
  tree.check();
  const double cube_bytes = sizeof(Cube) * static_cast<double>(tree.cubes());
  const double tree_bytes = kBytesPerNode * static_cast<double>(header.nodes) + cube_bytes;
  checkMemory(file, "the nodes of its tree", tree_bytes, options.memory_limit, "allow more memory");

  // Colours matter only for where the next node starts, and not at all in `.bt`.
  const std::vector<Cube> cubes = header.tree == "ColorOcTree" && !header.binary
                                      ? readTree<octomap::ColorOcTree>(header, file)
                                      : readTree<octomap::OcTree>(header, file);
  const Bounds known = knownSpace(cubes, header.resolution, file);
  VoxelMap map = makeMap({.file = file,
                          .extent = known,
                          .resolution = options.resolution.value_or(header.resolution),
                          .other_bytes = cube_bytes},
                         options);
  for (const Cube& cube : cubes) mark(map, boundsOf(cube, header.resolution), cube.state);
  markOutside(map, known, CellState::kUnknown);
  return map;
}

}  // namespace tautline::planning
