//! Patterns of sparse matrices, and colorings of their columns for compressed differentiation.

/// The places of a square matrix that can differ from zero, one column after the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::core) struct Pattern {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl Pattern {
    /// Creates the pattern of these places, as (row, column), and of the diagonal.
    pub fn of_places(n: usize, places: &[[usize; 2]]) -> Pattern {
        let mut starts = vec![0; n + 1];
        let diagonal = (0..n).map(|i| [i, i]);
        let all = || places.iter().copied().chain(diagonal.clone());
        all().for_each(|[_, j]| starts[j + 1] += 1);
        for j in 0..n {
            starts[j + 1] += starts[j];
        }
        let (mut next, mut rows) = (starts.clone(), vec![0; starts[n]]);
        for [i, j] in all() {
            rows[next[j]] = i;
            next[j] += 1;
        }
        let mut pattern = Pattern { starts: vec![0], rows: Vec::new() };
        for j in 0..n {
            let column = &mut rows[starts[j]..starts[j + 1]];
            column.sort_unstable();
            pattern.rows.extend(column.chunk_by(|a, b| a == b).map(|same| same[0]));
            pattern.starts.push(pattern.rows.len());
        }
        pattern
    }

    /// The number of rows, and of columns.
    pub fn size(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The number of places.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// The position of a column's first entry.
    pub fn start(&self, column: usize) -> usize {
        self.starts[column]
    }

    /// The rows of a column, in rising order.
    pub fn column(&self, column: usize) -> &[usize] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }

    /// The row and column of an entry.
    pub fn place(&self, k: usize) -> [usize; 2] {
        [self.rows[k], self.starts.partition_point(|&start| start <= k) - 1]
    }

    /// Returns a color for each column, from 0 on, such that columns of one color have no row in
    /// common, and the number of colors: a single direction yields all columns of a color (A. R.
    /// Curtis, M. J. D. Powell and J. K. Reid, IMA J. Appl. Math. 13 (1974) 117). Each column gets the
    /// first free color.
    ///
    /// A tridiagonal matrix takes three colors, the five-point Laplacian five to eight.
    pub fn colors(&self) -> (Vec<usize>, usize) {
        let n = self.size();
        let mut columns_of: Vec<Vec<usize>> = vec![Vec::new(); n];
        for j in 0..n {
            self.column(j).iter().for_each(|&i| columns_of[i].push(j));
        }
        let (mut colors, mut count) = (vec![usize::MAX; n], 0);
        // For each color, the column that last excluded it.
        let mut taken: Vec<usize> = Vec::new();
        for j in 0..n {
            for &other in self.column(j).iter().flat_map(|&i| &columns_of[i]) {
                if let Some(taken) = taken.get_mut(colors[other]) {
                    *taken = j;
                }
            }
            let color = taken.iter().position(|&by| by != j).unwrap_or(count);
            if color == count {
                count += 1;
                taken.push(usize::MAX);
            }
            colors[j] = color;
        }
        (colors, count)
    }
}
