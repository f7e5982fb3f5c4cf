#include "backend/graph/g2o_file.hpp"

#include <charconv>
#include <cmath>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop {
namespace {

// The words of one line, read in turn; every failure names file and line.
class LineReader {
 public:
  LineReader(std::string place, std::string_view line) : place_(std::move(place)), rest_(line) {}

  std::string_view word() {
    skip_blanks();
    const std::size_t end = std::min(rest_.find_first_of(" \t\r"), rest_.size());
    const std::string_view result = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return result;
  }
  int integer(const char* what) {
    const std::string_view text = word();
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) fail_at(what, text);
    return value;
  }
  double number(const char* what) {
    const std::string_view text = word();
    double value = 0.0;
    if (!parse_double(text, value)) fail_at(what, text);
    return value;
  }
  bool at_end() {
    skip_blanks();
    return rest_.empty();
  }
  void expect_end() {
    if (!at_end()) fail("has more fields than its tag allows");
  }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(place_ + " " + what); }

 private:
  void skip_blanks() {
    const std::size_t begin = std::min(rest_.find_first_not_of(" \t\r"), rest_.size());
    rest_.remove_prefix(begin);
  }
  [[noreturn]] void fail_at(const char* what, std::string_view text) const {
    if (text.empty()) fail(std::string("ends before ") + what + "; is the file truncated?");
    fail("has '" + std::string(text) + "' where " + what + " belongs");
  }

  std::string place_;
  std::string_view rest_;
};

Pose read_pose(LineReader& line) {
  Eigen::Vector3d t;
  Eigen::Vector4d q;
  for (int i = 0; i < 3; ++i) t[i] = line.number("a translation");
  for (int i = 0; i < 4; ++i) q[i] = line.number("a quaternion");
  const double norm = q.norm();
  if (norm < 1e-6) line.fail("has a quaternion of length zero");
  return Pose(Eigen::Quaterniond(q / norm), t);
}

GraphEdge read_edge(LineReader& line) {
  GraphEdge edge;
  edge.from = line.integer("a vertex id");
  edge.to = line.integer("a vertex id");
  edge.T_from_to = read_pose(line);
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      edge.information(i, j) = line.number("an entry of the information matrix");
      edge.information(j, i) = edge.information(i, j);
    }
  }
  return edge;
}

struct Reader {
  explicit Reader(const std::filesystem::path& file) : name(file.string()) {}

  [[nodiscard]] std::string place(std::size_t line) const {
    return name + ": line " + std::to_string(line);
  }

  void read_line(std::string_view text, std::size_t number) {
    LineReader line(place(number), text);
    const std::string_view tag = line.word();
    if (tag.empty() || tag.front() == '#') return;
    if (tag == "VERTEX_SE3:QUAT") {
      GraphVertex vertex;
      vertex.id = line.integer("a vertex id");
      vertex.pose = read_pose(line);
      line.expect_end();
      if (!position.emplace(vertex.id, static_cast<int>(position.size())).second) {
        line.fail("gives vertex " + std::to_string(vertex.id) + " a second time");
      }
      result.graph.vertices.push_back(vertex);
    } else if (tag == "EDGE_SE3:QUAT") {
      result.graph.edges.push_back(read_edge(line));
      line.expect_end();
      const std::string defect = defect_of(result.graph.edges.back());
      if (!defect.empty()) line.fail(defect);
      edge_lines.push_back(number);
    } else if (tag == "FIX") {
      do {
        fixed.emplace_back(line.integer("a vertex id"), number);
      } while (!line.at_end());
    } else {
      ++result.unknown_tags[std::string(tag)];
    }
  }

  [[nodiscard]] int vertex_at(int id, std::size_t line) const {
    const auto found = position.find(id);
    if (found != position.end()) return found->second;
    throw InputError(place(line) + " names vertex " + std::to_string(id) +
                     ", which the file does not have; add its VERTEX_SE3:QUAT line");
  }

  void finish() {
    PoseGraph& graph = result.graph;
    for (std::size_t k = 0; k < graph.edges.size(); ++k) {
      graph.edges[k].from = vertex_at(graph.edges[k].from, edge_lines[k]);
      graph.edges[k].to = vertex_at(graph.edges[k].to, edge_lines[k]);
    }
    for (const auto& [id, line] : fixed) graph.vertices[vertex_at(id, line)].fixed = true;
    if (graph.vertices.empty()) {
      throw InputError(name + ": no VERTEX_SE3:QUAT line; only SE(3) graphs are read");
    }
    classify_edges_by_successive_ids(graph);
  }

  std::string name;
  G2oFile result;
  std::unordered_map<int, int> position;  // of ids
  std::vector<std::size_t> edge_lines;
  std::vector<std::pair<int, std::size_t>> fixed;
};

void append(std::string& text, double value) {
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  text += ' ';
  text.append(buffer, end);
}

void append(std::string& text, const Pose& pose) {
  for (int i = 0; i < 3; ++i) append(text, pose.translation[i]);
  for (int i = 0; i < 4; ++i) append(text, pose.rotation.coeffs()[i]);
}

}  // namespace

G2oFile read_g2o(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  Reader reader(file);
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    reader.read_line(rest.substr(0, end), number);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  reader.finish();
  return std::move(reader.result);
}

void write_g2o(const std::filesystem::path& file, const PoseGraph& graph, bool with_rejected) {
  std::string text;
  for (const GraphVertex& vertex : graph.vertices) {
    text += "VERTEX_SE3:QUAT " + std::to_string(vertex.id);
    append(text, vertex.pose);
    text += '\n';
  }
  for (const GraphVertex& vertex : graph.vertices) {
    if (vertex.fixed) text += "FIX " + std::to_string(vertex.id) + "\n";
  }
  for (const GraphEdge& edge : graph.edges) {
    if (edge.rejected && !with_rejected) continue;
    text += "EDGE_SE3:QUAT " + std::to_string(graph.vertices[edge.from].id) + " " +
            std::to_string(graph.vertices[edge.to].id);
    append(text, edge.T_from_to);
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) append(text, edge.information(i, j));
    }
    text += '\n';
  }
  write_text_atomically(file, text);
}

}  // namespace groundloop
