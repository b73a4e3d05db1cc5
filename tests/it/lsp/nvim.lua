-- A session of Neovim with the language server: opens the files of the tour, reads what is found, applies one action for
-- each finding, renames a uniform, and saves. Prints what it does; leaves with status 1 when something does not come.
-- For Neovim 0.7 and later.

local program, folder = vim.env.SHADERCHECK, vim.env.TOUR
local function say(...)
  io.stdout:write(string.format(...) .. "\n")
end
local function fail(...)
  say(...)
  vim.cmd("cquit 1")
end

local config = { name = "shadercheck", cmd = { program, "lsp" }, root_dir = folder }
-- `vim.lsp.start` came with 0.8, and its forerunner leaves in later versions.
local start = vim.lsp.start_client or vim.lsp.start
local client
local files = { "scene.vert", "scene.frag", "grass.geom", "scene.cpp" }
local buffers = {}
for _, name in ipairs(files) do
  vim.cmd("edit " .. vim.fn.fnameescape(folder .. "/" .. name))
  buffers[name] = vim.api.nvim_get_current_buf()
  client = client or start(config)
  vim.lsp.buf_attach_client(buffers[name], client)
end
local encoding = "utf-16"

local function found()
  local all = {}
  for _, name in ipairs(files) do
    for _, d in ipairs(vim.diagnostic.get(buffers[name])) do
      local lsp = d.user_data and d.user_data.lsp or {}
      local related = lsp.relatedInformation and #lsp.relatedInformation or 0
      local first = vim.split(d.message, "\n")[1]
      table.insert(all, { name = name, d = d, related = related, message = first, code = d.code or lsp.code })
    end
  end
  table.sort(all, function(a, b)
    if a.name ~= b.name then return a.name < b.name end
    if a.d.lnum ~= b.d.lnum then return a.d.lnum < b.d.lnum end
    return a.d.col < b.d.col
  end)
  return all
end

local function wait_for(count)
  -- What is found comes again after each change: it counts once it stays.
  local since
  local there = vim.wait(30000, function()
    if #found() ~= count then
      since = nil
      return false
    end
    since = since or vim.loop.now()
    return vim.loop.now() - since > 700
  end, 20)
  if not there then
    for _, f in ipairs(found()) do
      say("left: %s:%d %s %s", f.name, f.d.lnum + 1, f.code, f.message)
    end
    fail("%d findings were expected", count)
  end
end

local function ask(buffer, method, params)
  local answers = vim.lsp.buf_request_sync(buffer, method, params, 10000)
  local answer = answers and answers[client]
  if not answer then
    fail("no answer to %s", method)
  end
  return answer.result, answer.err or answer.error
end

wait_for(10)
for _, f in ipairs(found()) do
  say("%s:%d:%d %s %s", f.name, f.d.lnum + 1, f.d.col + 1, f.code, f.message)
end

for number = 1, 10 do
  local f = found()[1]
  local buffer = buffers[f.name]
  local range = {
    start = { line = f.d.lnum, character = f.d.col },
    ["end"] = { line = f.d.end_lnum, character = f.d.end_col },
  }
  local document = { uri = vim.uri_from_bufnr(buffer) }
  local context = { diagnostics = {}, only = { "quickfix" } }
  local actions = ask(buffer, "textDocument/codeAction", { textDocument = document, range = range, context = context })
  local chosen
  for _, action in ipairs(actions or {}) do
    local code = action.diagnostics[1].code
    if code == f.code and not chosen then
      chosen = action
    end
  end
  if not chosen then
    fail("no action for %s", f.code)
  end
  say("%d. %s: %s%s", number, f.name, chosen.title, chosen.isPreferred and " [preferred]" or "")
  vim.lsp.util.apply_workspace_edit(chosen.edit, encoding)
  wait_for(10 - number)
end

local vertex = buffers["scene.vert"]
local line = vim.fn.match(vim.api.nvim_buf_get_lines(vertex, 0, -1, false), "uniform mat4 projection")
local at = { textDocument = { uri = vim.uri_from_bufnr(vertex) }, position = { line = line, character = 14 } }
local _, refused = ask(vertex, "textDocument/rename", vim.tbl_extend("error", at, { newName = "uniform" }))
say("rename to a keyword: %s", refused and refused.message or fail("was not refused"))
local edit = ask(vertex, "textDocument/rename", vim.tbl_extend("error", at, { newName = "lens" }))
local changed = 0
for uri, edits in pairs(edit.changes) do
  changed = changed + 1
  say("rename: %d places in %s", #edits, vim.fn.fnamemodify(vim.uri_to_fname(uri), ":t"))
end
if changed < 2 then
  fail("a uniform and its look-up stand in two files")
end
vim.lsp.util.apply_workspace_edit(edit, encoding)
wait_for(0)
vim.cmd("silent wall")
vim.lsp.stop_client(client)
say("saved")
vim.cmd("qall!")
