# One word for each task of a contributor: `just` lists them. They run the tools of the active environment,
# pip install -e '.[dev]'.

[private]
default:
    @just --list --unsorted

# Build the extension module again, after a change in core/, mesher/ or bindings/
build:
    maturin develop --release

# Run tests of Python: all, or those of the given files
test *files:
    python -m pytest {{ files }}

# Run tests of Rust
core:
    cargo test --release --workspace

# Check style and types, without changing files
lint:
    cargo fmt --all --check
    cargo clippy --release --workspace --all-targets -- -D warnings
    ruff check
    ruff format --check
    mypy

# Format all files
format:
    cargo fmt --all
    ruff format

# Write the generated pages, then build the site
docs:
    python docs/tables.py
    sphinx-build -nW --keep-going docs docs/_build/html

# Check the answers of the benchmarks, without timing
bench:
    .ci/bench

# Build a wheel, check it, and use it in an environment without Rust
wheel:
    maturin build --release --out dist
    python .ci/wheel.py dist/signorini-*.whl

# Everything that continuous integration runs, in a fresh environment
all:
    .ci/run
