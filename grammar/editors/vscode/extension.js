// Starts `msk lsp` and lets the editor speak to it.

const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

exports.activate = function () {
  const command = workspace.getConfiguration("msk").get("path", "msk");
  const server = { command, args: ["lsp"] };
  const wishes = {
    documentSelector: [{ language: "msk" }],
    synchronize: { fileEvents: workspace.createFileSystemWatcher("**/*.msk") },
  };
  client = new LanguageClient("msk", "MSK", server, wishes);
  return client.start();
};

exports.deactivate = function () {
  return client?.stop();
};
