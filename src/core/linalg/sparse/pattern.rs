//! Sparsity patterns of matrices, and colorings of their columns for compressed differentiation.

/// The entries of a square matrix that can differ from zero, in column-major order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::core) struct Pattern {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl Pattern {
    /// Creates the pattern that contains the given entries, each as (row, column), and the
    /// diagonal.
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

    /// Returns the number of rows, which equals the number of columns.
    pub fn size(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Returns the number of entries of the pattern.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// Returns the position of a column's first entry in the pattern.
    pub fn start(&self, column: usize) -> usize {
        self.starts[column]
    }

    /// Returns the rows of a column's entries, in increasing order.
    pub fn column(&self, column: usize) -> &[usize] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }

    /// Returns the row and the column of an entry.
    pub fn place(&self, k: usize) -> [usize; 2] {
        [self.rows[k], self.starts.partition_point(|&start| start <= k) - 1]
    }

    /// Returns a color for each column, counted from 0, and the number of colors; no two columns of
    /// one color have an entry in the same row, so that a single direction of differentiation yields
    /// all columns of a color (A. R. Curtis, M. J. D. Powell and J. K. Reid, IMA J. Appl. Math. 13
    /// (1974) 117). Each column gets the first color that is free in all of its rows.
    ///
    /// A tridiagonal matrix needs three colors, and the five-point Laplacian needs five to eight.
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
