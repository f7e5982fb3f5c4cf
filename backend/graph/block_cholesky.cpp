#include "backend/graph/block_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include <Eigen/Cholesky>
#include <cholmod.h>

#include "backend/graph/single_threaded_algebra.hpp"
#include "frontend/core/error.hpp"

// Eigen's own product is compiled for any processor; BLAS chooses at run time.
extern "C" void dgemm_(const char* transpose_a, const char* transpose_b, const int* rows,
                       const int* columns, const int* inner, const double* alpha, const double* a,
                       const int* stride_a, const double* b, const int* stride_b,
                       const double* beta, double* c, const int* stride_c);

namespace groundloop {
namespace {

// Where a block lies among the values: its first entry, the distance of its columns, and whether it
// is kept transposed.
struct Place {
  std::size_t first = 0;
  int stride = 0;
  bool transposed = false;
};

using Column = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using MutableColumn = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const auto rows = static_cast<int>(a.rows());
  const auto columns = static_cast<int>(b.cols());
  const auto inner = static_cast<int>(a.cols());
  const double one = 1.0;
  const double zero = 0.0;
  Eigen::MatrixXd c(rows, columns);
  dgemm_("N", "N", &rows, &columns, &inner, &one, a.data(), &rows, b.data(), &inner, &zero,
         c.data(), &rows);
  return c;
}

}  // namespace

// Positions are blocks in the order of elimination; scalars of the matrix follow it. CHOLMOD orders
// them once more (postorder), which is undone only where its factor is read.
struct BlockCholesky::Parts {
  std::vector<int> sizes, position;  // by block
  std::vector<int> start;            // first scalar of each block as given, and the number of all
  std::vector<int> first;            // first scalar of each block in order of elimination
  std::vector<Place> diagonal, pairs;
  std::vector<int> column_start, row_index;
  std::vector<double> values;
  cholmod_common common{};
  cholmod_sparse matrix{};
  cholmod_factor* factor = nullptr;
  std::vector<double> inverse;  // laid out as the factor's supernodes
  std::vector<int> supernode_of, factor_row;

  Parts() {
    cholmod_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
  }
  ~Parts() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  void order(const std::vector<std::pair<int, int>>& below);
  void lay_out(const std::vector<std::pair<int, int>>& below);
  void analyse();

  [[nodiscard]] int rows() const { return start.back(); }
  // Of a supernode: its rows, and the values of the factor or the inverse, column by column.
  [[nodiscard]] int columns_of(int s) const {
    const int* super = static_cast<const int*>(factor->super);
    return super[s + 1] - super[s];
  }
  [[nodiscard]] int rows_of(int s) const {
    const int* pi = static_cast<const int*>(factor->pi);
    return pi[s + 1] - pi[s];
  }
  [[nodiscard]] const int* row_list(int s) const {
    return static_cast<const int*>(factor->s) + static_cast<const int*>(factor->pi)[s];
  }
  [[nodiscard]] std::size_t values_at(int s) const {
    return static_cast<std::size_t>(static_cast<const int*>(factor->px)[s]);
  }
  [[nodiscard]] Column factor_of(int s) const {
    return {static_cast<const double*>(factor->x) + values_at(s), rows_of(s), columns_of(s),
            Eigen::OuterStride<>(rows_of(s))};
  }
  [[nodiscard]] MutableColumn inverse_of(int s) {
    return {inverse.data() + values_at(s), rows_of(s), columns_of(s),
            Eigen::OuterStride<>(rows_of(s))};
  }
  Eigen::MatrixXd gathered(int s, std::vector<int>& local);
};

// Approximate minimum degree of the graph of blocks.
void BlockCholesky::Parts::order(const std::vector<std::pair<int, int>>& below) {
  const int n = static_cast<int>(sizes.size());
  std::vector<int> starts(n + 1, 0), rows;
  rows.reserve(below.size());
  for (const auto& [i, j] : below) {
    ++starts[j + 1];
    rows.push_back(i);
  }
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  cholmod_sparse pattern{};
  pattern.nrow = pattern.ncol = static_cast<std::size_t>(n);
  pattern.nzmax = rows.size();
  pattern.p = starts.data();
  pattern.i = rows.data();
  pattern.stype = -1;
  pattern.itype = CHOLMOD_INT;
  pattern.xtype = CHOLMOD_PATTERN;
  pattern.sorted = pattern.packed = 1;
  std::vector<int> block_at(n);
  check(n == 0 || cholmod_amd(&pattern, nullptr, 0, block_at.data(), &common) != 0,
        "an order of elimination is found");
  position.resize(n);
  first.resize(n);
  int next = 0;
  for (int p = 0; p < n; ++p) {
    position[block_at[p]] = p;
    first[block_at[p]] = next;
    next += sizes[block_at[p]];
  }
}

// The lower triangle, compressed by columns; all columns of a block have the same rows.
void BlockCholesky::Parts::lay_out(const std::vector<std::pair<int, int>>& below) {
  const int n = static_cast<int>(sizes.size());
  std::vector<int> block_at(n);
  for (int b = 0; b < n; ++b) block_at[position[b]] = b;
  std::vector<std::vector<int>> under(n);  // positions, by position of the column
  for (const auto& [i, j] : below) {
    under[std::min(position[i], position[j])].push_back(std::max(position[i], position[j]));
  }
  diagonal.resize(n);
  column_start.assign(1, 0);
  for (int p = 0; p < n; ++p) {
    std::sort(under[p].begin(), under[p].end());
    const int b = block_at[p];
    int height = sizes[b];
    for (const int q : under[p]) height += sizes[block_at[q]];
    diagonal[b] = {static_cast<std::size_t>(column_start.back()), height, false};
    for (int c = 0; c < sizes[b]; ++c) {
      for (int r = 0; r < sizes[b]; ++r) row_index.push_back(first[b] + r);
      for (const int q : under[p]) {
        for (int r = 0; r < sizes[block_at[q]]; ++r) row_index.push_back(first[block_at[q]] + r);
      }
      column_start.push_back(static_cast<int>(row_index.size()));
    }
  }
  values.assign(row_index.size(), 0.0);
}

void BlockCholesky::Parts::analyse() {
  matrix.nrow = matrix.ncol = static_cast<std::size_t>(rows());
  matrix.nzmax = values.size();
  matrix.p = column_start.data();
  matrix.i = row_index.data();
  matrix.x = values.data();
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_REAL;
  matrix.sorted = matrix.packed = 1;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_NATURAL;
  factor = cholmod_analyze(&matrix, &common);
  check(factor != nullptr, "CHOLMOD analyses the matrix");
}

BlockCholesky::BlockCholesky(std::vector<int> sizes, const std::vector<std::pair<int, int>>& pairs)
    : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.sizes = std::move(sizes);
  p.start.assign(1, 0);
  for (const int size : p.sizes) p.start.push_back(p.start.back() + size);
  if (p.rows() == 0) return;
  // The pairs as (row, column) of a lower triangle, each once.
  std::vector<std::pair<int, int>> by_column;
  by_column.reserve(pairs.size());
  for (const auto& [i, j] : pairs) by_column.emplace_back(std::min(i, j), std::max(i, j));
  std::sort(by_column.begin(), by_column.end());
  by_column.erase(std::unique(by_column.begin(), by_column.end()), by_column.end());
  std::vector<std::pair<int, int>> below;
  below.reserve(by_column.size());
  for (const auto& [column, row] : by_column) below.emplace_back(row, column);
  const SingleThreadedAlgebra one_thread;
  p.order(below);
  p.lay_out(below);
  p.analyse();
  p.pairs.reserve(pairs.size());
  for (const auto& [i, j] : pairs) {
    const bool transposed = p.position[i] < p.position[j];
    const Place& column = p.diagonal[transposed ? i : j];
    const int* begin = p.row_index.data() + column.first;
    const int* found = std::lower_bound(begin, begin + column.stride, p.first[transposed ? j : i]);
    p.pairs.push_back(
        {column.first + static_cast<std::size_t>(found - begin), column.stride, transposed});
  }
}

BlockCholesky::~BlockCholesky() = default;

int BlockCholesky::rows() const { return parts_->rows(); }

void BlockCholesky::set_zero() { std::fill(parts_->values.begin(), parts_->values.end(), 0.0); }

void BlockCholesky::add_diagonal(int i, const Eigen::Ref<const Eigen::MatrixXd>& block) {
  const Place& place = parts_->diagonal[i];
  for (Eigen::Index c = 0; c < block.cols(); ++c) {
    double* column = parts_->values.data() + place.first + c * place.stride;
    for (Eigen::Index r = 0; r < block.rows(); ++r) column[r] += block(r, c);
  }
}

void BlockCholesky::add_pair(std::size_t pair, const Eigen::Ref<const Eigen::MatrixXd>& block) {
  const Place& place = parts_->pairs[pair];
  for (Eigen::Index c = 0; c < block.cols(); ++c) {
    for (Eigen::Index r = 0; r < block.rows(); ++r) {
      const Eigen::Index row = place.transposed ? c : r;
      const Eigen::Index column = place.transposed ? r : c;
      parts_->values[place.first + static_cast<std::size_t>(column * place.stride + row)] +=
          block(r, c);
    }
  }
}

bool BlockCholesky::factorise() {
  Parts& p = *parts_;
  if (p.rows() == 0) return true;
  p.matrix.x = p.values.data();
  const SingleThreadedAlgebra one_thread;
  cholmod_factorize(&p.matrix, p.factor, &p.common);
  return p.common.status == CHOLMOD_OK;
}

Eigen::MatrixXd BlockCholesky::solve(const Eigen::MatrixXd& right) const {
  Parts& p = *parts_;
  const int n = p.rows();
  if (n == 0) return right;
  Eigen::MatrixXd ordered(right.rows(), right.cols());
  for (std::size_t b = 0; b < p.sizes.size(); ++b)
    ordered.middleRows(p.first[b], p.sizes[b]) = right.middleRows(p.start[b], p.sizes[b]);
  cholmod_dense b{};
  b.nrow = b.d = static_cast<std::size_t>(n);
  b.ncol = static_cast<std::size_t>(right.cols());
  b.nzmax = b.nrow * b.ncol;
  b.x = ordered.data();
  b.xtype = CHOLMOD_REAL;
  const SingleThreadedAlgebra one_thread;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, p.factor, &b, &p.common);
  check(x != nullptr, "CHOLMOD solves");
  std::memcpy(ordered.data(), x->x, b.nzmax * sizeof(double));
  cholmod_free_dense(&x, &p.common);
  Eigen::MatrixXd result(right.rows(), right.cols());
  for (std::size_t k = 0; k < p.sizes.size(); ++k)
    result.middleRows(p.start[k], p.sizes[k]) = ordered.middleRows(p.first[k], p.sizes[k]);
  return result;
}

double BlockCholesky::log_determinant() const {
  const Parts& p = *parts_;
  if (p.rows() == 0) return 0.0;
  double sum = 0.0;
  for (int s = 0; s < static_cast<int>(p.factor->nsuper); ++s)
    sum += 2.0 * p.factor_of(s).diagonal().array().log().sum();
  return sum;
}

// The inverse among the rows below supernode s, from the supernodes already inverted.
Eigen::MatrixXd BlockCholesky::Parts::gathered(int s, std::vector<int>& local) {
  const int columns = columns_of(s);
  const int below = rows_of(s) - columns;
  const int* rows = row_list(s) + columns;
  Eigen::MatrixXd result(below, below);
  for (int j = 0; j < below;) {
    const int t = supernode_of[rows[j]];
    const int first_column = static_cast<const int*>(factor->super)[t];
    for (int k = 0; k < rows_of(t); ++k) local[row_list(t)[k]] = k;
    const MutableColumn column = inverse_of(t);
    for (; j < below && supernode_of[rows[j]] == t; ++j) {
      for (int i = j; i < below; ++i)
        result(i, j) = result(j, i) = column(local[rows[i]], rows[j] - first_column);
    }
  }
  return result;
}

void BlockCholesky::invert_pattern() {
  Parts& p = *parts_;
  if (p.rows() == 0) return;
  const int supernodes = static_cast<int>(p.factor->nsuper);
  p.inverse.assign(p.factor->xsize, 0.0);
  p.supernode_of.resize(p.rows());
  for (int s = 0; s < supernodes; ++s) {
    for (int c = 0; c < p.columns_of(s); ++c) p.supernode_of[p.row_list(s)[c]] = s;
  }
  p.factor_row.resize(p.rows());
  for (int r = 0; r < p.rows(); ++r) p.factor_row[static_cast<const int*>(p.factor->Perm)[r]] = r;
  std::vector<int> local(p.rows(), 0);
  const SingleThreadedAlgebra one_thread;
  for (int s = supernodes; s-- > 0;) {
    const int columns = p.columns_of(s);
    const int below = p.rows_of(s) - columns;
    const auto L = p.factor_of(s);
    const auto triangle = L.topRows(columns).triangularView<Eigen::Lower>();
    const Eigen::MatrixXd root = triangle.solve(Eigen::MatrixXd::Identity(columns, columns));
    MutableColumn S = p.inverse_of(s);
    S.topRows(columns).noalias() = root.transpose() * root;
    if (below == 0) continue;
    const Eigen::MatrixXd G = product(L.bottomRows(below), root);
    const Eigen::MatrixXd SG = product(p.gathered(s, local), G);
    S.bottomRows(below) = -SG;
    S.topRows(columns) += product(G.transpose(), SG);
  }
}

Eigen::MatrixXd BlockCholesky::inverse_block(int i, int j) const {
  Parts& p = *parts_;
  Eigen::MatrixXd result(p.sizes[i], p.sizes[j]);
  for (int r = 0; r < p.sizes[i]; ++r) {
    for (int c = 0; c < p.sizes[j]; ++c) {
      int row = p.factor_row[p.first[i] + r];
      int column = p.factor_row[p.first[j] + c];
      if (row < column) std::swap(row, column);
      const int s = p.supernode_of[column];
      const int* begin = p.row_list(s);
      const int* found = std::lower_bound(begin, begin + p.rows_of(s), row);
      check(found != begin + p.rows_of(s) && *found == row, "the block is in the pattern");
      result(r, c) =
          p.inverse_of(s)(found - begin, column - static_cast<const int*>(p.factor->super)[s]);
    }
  }
  return result;
}

}  // namespace groundloop
