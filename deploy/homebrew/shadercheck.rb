# Formula for a tap, which builds from source. The sum is that of the release's source archive: deploy/release.md.
class Shadercheck < Formula
  desc "Property tests, lint and reference data for shaders, on a machine without a GPU"
  homepage "https://github.com/OWNER/shadercheck"
  url "https://github.com/OWNER/shadercheck/archive/refs/tags/v0.1.0.tar.gz"
  sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  license any_of: ["MIT", "Apache-2.0"]

  depends_on "rust" => :build

  def install
    system "cargo", "install", *std_cargo_args
    generate_completions_from_executable(bin/"shadercheck", "completions")
    system bin/"shadercheck", "man", buildpath/"man"
    man1.install Dir["man/*.1"]
  end

  test do
    (testpath/"a.vert").write <<~GLSL
      #version 330 core
      in vec4 p;
      void main() { gl_Position = vec4(vec3(p.x, p.y, p.z, 1.0), 1.0); }
    GLSL
    assert_match "T001", shell_output("#{bin}/shadercheck lint a.vert", 1)
  end
end
